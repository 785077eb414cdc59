#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace flotsam {

/// Running 64-bit FNV-1a over raw bytes, to compare states bit for bit. **Source:** Fowler, Noll, Vo.
class StateHash {
  public:
    void add_bytes(const void* data, std::size_t size)
    {
        const auto* bytes = static_cast<const unsigned char*>(data);
        for (std::size_t k = 0; k < size; ++k) value_ = (value_ ^ bytes[k]) * 0x100000001b3ULL;
    }
    template <class T>
    void add(std::span<const T> values)
    {
        add_bytes(values.data(), values.size_bytes());
    }
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

} // namespace flotsam
