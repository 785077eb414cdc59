#include "flotsam/core/parallel.hpp"

#include "flotsam/core/contracts.hpp"

#if defined(FLOTSAM_PLAIN_THREADS)
#include "core/plain_threads.hpp"
#endif

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>

namespace flotsam {

namespace {

class TbbArena {
  public:
    explicit TbbArena(int threads)
    {
        if (threads > tbb::info::default_concurrency()) {
            more_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
        }
        arena_.initialize(threads);
    }
    void run(std::size_t chunks, FunctionRef<void(std::size_t)> body)
    {
        arena_.execute([&] {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  for (std::size_t chunk = range.begin(); chunk < range.end(); ++chunk) body(chunk);
                              });
        });
    }

  private:
    /// TBB starts no more threads than the machine has cores, and complains on stderr, unless it is told otherwise.
    std::optional<tbb::global_control> more_;
    tbb::task_arena arena_;
};

} // namespace

struct Workers::Arena {
    int threads;
#if defined(FLOTSAM_PLAIN_THREADS)
    PlainThreads team;
#else
    TbbArena team;
#endif
    explicit Arena(int count) : threads(count), team(count) {}
};

Workers::Workers(int threads)
{
    require(threads >= 0 && threads <= 1024, "threads must be from 1 to 1024, or 0 for all the machine has", threads);
    const int count = threads > 0 ? threads : std::max(1, tbb::info::default_concurrency());
    arena_ = std::make_unique<Arena>(count);
}

Workers::~Workers() = default;
Workers::Workers(Workers&&) noexcept = default;
Workers& Workers::operator=(Workers&&) noexcept = default;

int Workers::threads() const
{
    return arena_->threads;
}

void Workers::for_tasks(std::size_t count, FunctionRef<void(std::size_t)> body) const
{
    if (arena_->threads == 1 || count < 2) {
        for (std::size_t task = 0; task < count; ++task) body(task);
        return;
    }
    arena_->team.run(count, body);
}

void Workers::for_chunks(std::size_t items, FunctionRef<void(std::size_t, std::size_t, std::size_t)> body) const
{
    for_tasks(chunk_count(items),
              [&](std::size_t chunk) { body(chunk, chunk * kChunk, std::min(items, (chunk + 1) * kChunk)); });
}

} // namespace flotsam
