#include "scene/frame_writer.hpp"

#include "flotsam/core/contracts.hpp"

#include <utility>

namespace flotsam::scene {
namespace {

/// What the call threw; null: nothing. Its exception is out of the hands of this thread when the caller passes it on.
std::exception_ptr thrown_by(const FrameWriter::Frame& frame)
{
    try {
        frame();
        return nullptr;
    } catch (...) {
        return std::current_exception();
    }
}

} // namespace

FrameWriter::FrameWriter(std::size_t most_waiting) : most_waiting_(most_waiting)
{
    require(most_waiting >= 1, "at least one frame must be able to wait", most_waiting);
    thread_ = std::thread([this] { write_frames(); });
}

FrameWriter::~FrameWriter()
{
    {
        const std::lock_guard lock(mutex_);
        quit_ = true;
    }
    added_.notify_one();
    thread_.join();
}

void FrameWriter::add(Frame frame)
{
    {
        std::unique_lock lock(mutex_);
        taken_.wait(lock, [&] { return failure_ || waiting_.size() < most_waiting_; });
        rethrow_failure();
        waiting_.push_back(std::move(frame));
    }
    added_.notify_one();
}

void FrameWriter::wait()
{
    std::unique_lock lock(mutex_);
    taken_.wait(lock, [&] { return waiting_.empty() && !writing_; });
}

void FrameWriter::check()
{
    const std::lock_guard lock(mutex_);
    rethrow_failure();
}

void FrameWriter::write_frames()
{
    std::unique_lock lock(mutex_);
    for (;;) {
        added_.wait(lock, [&] { return quit_ || !waiting_.empty(); });
        if (waiting_.empty()) return;
        writing_ = true;
        Frame frame = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        taken_.notify_one();
        std::exception_ptr failure = thrown_by(frame);
        frame = nullptr; // its memory is back before the next one is let in
        lock.lock();
        writing_ = false;
        if (failure) {
            failure_ = std::move(failure);
            waiting_.clear();
        }
        taken_.notify_one();
    }
}

void FrameWriter::rethrow_failure() const
{
    if (failure_) std::rethrow_exception(failure_);
}

} // namespace flotsam::scene
