#pragma once

#include "flotsam/core/parallel.hpp"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace flotsam {

/// A team of std::threads in TBB's place for the thread sanitizer, which sees no synchronisation inside a library that
/// is not instrumented: with TBB it reports races in loops that have none, and suppressing those hides the real ones.
/// Here every edge is a mutex's, at the ends of a loop; between the chunks of a loop there is none.
class PlainThreads {
  public:
    explicit PlainThreads(int threads)
    {
        for (int k = 1; k < threads; ++k) threads_.emplace_back([this] { serve(); });
    }
    ~PlainThreads()
    {
        {
            const std::lock_guard lock(mutex_);
            quit_ = true;
        }
        wake_.notify_all();
        for (std::thread& thread : threads_) thread.join();
    }
    PlainThreads(const PlainThreads&) = delete;
    PlainThreads& operator=(const PlainThreads&) = delete;

    /// Calls body(chunk) for each of `chunks`; a loop inside a loop runs on its caller's thread.
    void run(std::size_t chunks, FunctionRef<void(std::size_t)> body)
    {
        if (busy_.exchange(true)) {
            for (std::size_t chunk = 0; chunk < chunks; ++chunk) body(chunk);
            return;
        }
        {
            const std::lock_guard lock(mutex_);
            body_ = &body;
            chunks_ = chunks;
            next_.store(0, std::memory_order_relaxed);
            working_ = threads_.size();
            failure_ = nullptr;
            ++loop_;
        }
        wake_.notify_all();
        take_chunks();
        std::unique_lock lock(mutex_);
        done_.wait(lock, [&] { return working_ == 0; });
        busy_ = false;
        if (failure_) std::rethrow_exception(failure_);
    }

  private:
    void serve()
    {
        std::unique_lock lock(mutex_);
        for (std::size_t seen = 0;;) {
            wake_.wait(lock, [&] { return quit_ || loop_ != seen; });
            if (quit_) return;
            seen = loop_;
            lock.unlock();
            take_chunks();
            lock.lock();
            if (--working_ == 0) done_.notify_one();
        }
    }

    void take_chunks()
    {
        try { // relaxed: the counter must not order the chunks for the sanitizer
            for (std::size_t chunk; (chunk = next_.fetch_add(1, std::memory_order_relaxed)) < chunks_;) (*body_)(chunk);
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
        }
    }

    std::vector<std::thread> threads_; ///< besides the caller's
    std::mutex mutex_;
    std::condition_variable wake_, done_;
    std::atomic<bool> busy_ = false;
    std::atomic<std::size_t> next_ = 0;
    const FunctionRef<void(std::size_t)>* body_ = nullptr;
    std::size_t chunks_ = 0, working_ = 0, loop_ = 0;
    std::exception_ptr failure_;
    bool quit_ = false;
};

} // namespace flotsam
