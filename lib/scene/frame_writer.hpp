#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace flotsam::scene {

/// Writes frames on a thread of its own, in the order in which they were added, while the simulation goes on.
///
/// A frame is a call that holds copies of what it writes, or what nobody changes any more. At most `most_waiting`
/// frames wait for the one that is being written; then add() waits too, so that a slow disk or long pictures take time
/// and no memory. The first frame that throws is the last one called: those behind it are dropped, and what it threw
/// comes out of the next call of add() or check(), and of all after that. All members are for one thread, the
/// simulation's.
class FrameWriter {
  public:
    using Frame = std::function<void()>;
    static constexpr std::size_t kMostWaiting = 3;

    explicit FrameWriter(std::size_t most_waiting = kMostWaiting);
    /// Writes what still waits. What goes wrong with it is lost: wait() and check() before.
    ~FrameWriter();
    FrameWriter(const FrameWriter&) = delete;
    FrameWriter& operator=(const FrameWriter&) = delete;

    /// Hands a frame over. Throws what an earlier frame threw.
    void add(Frame frame);
    /// Returns when nothing is being written any more and nothing waits.
    void wait();
    /// Throws what a frame threw.
    void check();

  private:
    void write_frames();
    void rethrow_failure() const;

    const std::size_t most_waiting_;
    std::mutex mutex_; ///< of all below but the thread
    std::condition_variable added_, taken_;
    std::deque<Frame> waiting_;
    std::exception_ptr failure_;
    bool writing_ = false; ///< a frame is out of the queue and not done
    bool quit_ = false;
    std::thread thread_; ///< last: it uses all of the above
};

} // namespace flotsam::scene
