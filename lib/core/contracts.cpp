#include "flotsam/core/contracts.hpp"

#include <cstdio>
#include <cstdlib>

namespace flotsam::detail {

void assertion_failed(const char* condition, const char* reason, const char* file, int line)
{
    std::fprintf(stderr, "%s:%d: flotsam's own mistake: %s (%s)\n", file, line, reason, condition);
    std::abort();
}

} // namespace flotsam::detail
