#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace flotsam {

/// A borrowed callable: two words, no allocation, valid while the callable lives.
template <class Signature>
class FunctionRef;

template <class Result, class... Args>
class FunctionRef<Result(Args...)> {
  public:
    template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef> && std::is_invocable_r_v<Result, F&, Args...>)
        FunctionRef(F&& callable) // NOLINT(google-explicit-constructor): taken as an argument only
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))),
          call_([](void* object, Args... args) -> Result {
              return (*static_cast<std::remove_reference_t<F>*>(object))(std::forward<Args>(args)...);
          })
    {
    }
    Result operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

  private:
    void* object_;
    Result (*call_)(void*, Args...);
};

/// A team of worker threads of its own (a TBB task arena), so that loops keep out of the application's threads.
///
/// Chunk borders depend on the loop's size only, never on the number of threads; a worker writes its own slots, and
/// sums over chunks are taken in chunk order. So every result repeats bit for bit for any number of threads.
class Workers {
  public:
    /// `threads`: 1 or more; 0 takes what the machine has.
    explicit Workers(int threads = 0);
    ~Workers();
    Workers(Workers&&) noexcept;
    Workers& operator=(Workers&&) noexcept;
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    [[nodiscard]] int threads() const;

    static constexpr std::size_t kChunk = 256; ///< items a chunk

    [[nodiscard]] static std::size_t chunk_count(std::size_t items) { return (items + kChunk - 1) / kChunk; }

    /// Calls body(task) for each of [0, count), in parallel; for tasks of some microseconds at least.
    void for_tasks(std::size_t count, FunctionRef<void(std::size_t)> body) const;

    /// Calls body(chunk, begin, end) for each chunk of [0, items), in parallel.
    void for_chunks(std::size_t items, FunctionRef<void(std::size_t, std::size_t, std::size_t)> body) const;

    /// Calls body(i) for each i in [0, items), in parallel.
    template <class Body>
    void for_each(std::size_t items, Body&& body) const
    {
        for_chunks(items, [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) body(i);
        });
    }

    /// Sum of term(i) over [0, items): each chunk in order, then the chunks in order. `Sum` needs += and a zero
    /// default; `scratch` keeps its capacity between calls, so that none allocates after the first.
    template <class Sum, class Term>
    Sum ordered_sum(std::size_t items, std::vector<Sum>& scratch, Term&& term) const
    {
        scratch.assign(chunk_count(items), Sum{});
        for_chunks(items, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Sum sum{};
            for (std::size_t i = begin; i < end; ++i) sum += term(i);
            scratch[chunk] = sum;
        });
        Sum total{};
        for (const Sum& part : scratch) total += part;
        return total;
    }

  private:
    struct Arena;
    std::unique_ptr<Arena> arena_;
};

} // namespace flotsam
