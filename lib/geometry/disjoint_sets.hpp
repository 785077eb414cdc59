#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace flotsam {

/// Numbers that were joined to sets, each named by its least.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count = 0) { reset(count); }
    /// Each number a set of its own again; room is kept.
    void reset(std::size_t count)
    {
        parent_.resize(count);
        std::iota(parent_.begin(), parent_.end(), std::size_t(0));
    }
    /// Room for so many numbers.
    void reserve(std::size_t count) { parent_.reserve(count); }
    [[nodiscard]] std::size_t find(std::size_t k)
    {
        while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
        return k;
    }
    void join(std::size_t a, std::size_t b)
    {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::size_t> parent_;
};

} // namespace flotsam
