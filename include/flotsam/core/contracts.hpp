#pragma once

#include <sstream>
#include <stdexcept>
#include <string_view>

namespace flotsam {

/// Checks what a caller passed in. `condition` is written in its positive form, so that NaN fails it.
/// Throws std::invalid_argument "<allowed>, given <given>".
template <class Given>
void require(bool condition, std::string_view allowed, const Given& given)
{
    if (condition) return;
    std::ostringstream sentence;
    sentence << allowed << ", given " << given;
    throw std::invalid_argument(sentence.str());
}

inline void require(bool condition, std::string_view allowed)
{
    if (!condition) throw std::invalid_argument(std::string(allowed));
}

/// What a program was given by its user (a file, a mesh, a scene) cannot be used; what() is one sentence that
/// names the file, the place and what is allowed.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

namespace detail {
[[noreturn]] void assertion_failed(const char* condition, const char* reason, const char* file, int line);
} // namespace detail

} // namespace flotsam

#if defined(FLOTSAM_ENABLE_ASSERTS)
#define FLOTSAM_ASSERT(condition, reason)                                                                              \
    ((condition) ? void(0) : ::flotsam::detail::assertion_failed(#condition, reason, __FILE__, __LINE__))
#else
#define FLOTSAM_ASSERT(condition, reason) static_cast<void>(sizeof(condition))
#endif
