#include "flotsam/io/output_error.hpp"
#include "scene/frame_writer.hpp"
#include "support/catch.hpp"

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <numeric>
#include <vector>

using namespace flotsam;
using scene::FrameWriter;
using namespace std::chrono_literals;

TEST_CASE("frames are written in the order in which they were added", "[scene][frames]")
{
    std::vector<int> written; // by one thread only, read when it has nothing to do
    std::vector<int> expected(50);
    std::iota(expected.begin(), expected.end(), 0);
    const auto add_all = [&](FrameWriter& writer) {
        for (const int frame : expected) writer.add([&written, frame] { written.push_back(frame); });
    };
    SECTION("all are there after wait")
    {
        FrameWriter writer;
        add_all(writer);
        writer.wait();
        CHECK(written == expected);
    }
    SECTION("all are there when the writer is gone")
    {
        add_all(*std::make_unique<FrameWriter>());
        CHECK(written == expected);
    }
}

TEST_CASE("frames are written beside the thread that adds them", "[scene][frames]")
{
    std::promise<void> may_end;
    std::thread::id thread;
    FrameWriter writer;
    writer.add([&] {
        thread = std::this_thread::get_id();
        may_end.get_future().wait();
    });
    may_end.set_value(); // not reached, were the frame written by add()
    writer.wait();
    CHECK(thread != std::this_thread::get_id());
}

TEST_CASE("add waits while as many frames wait as may", "[scene][frames]")
{
    std::promise<void> may_end;
    std::atomic<int> added = 0;
    FrameWriter writer(2);
    auto adding = std::async(std::launch::async, [&] {
        for (int frame = 0; frame < 6; ++frame) {
            writer.add([&, frame] {
                if (frame == 0) may_end.get_future().wait();
            });
            ++added;
        }
    });
    // The one that is being written, and two that wait. Whatever the machine does meanwhile, it must not be more.
    while (added < 3) std::this_thread::yield();
    CHECK(adding.wait_for(50ms) == std::future_status::timeout);
    CHECK(added == 3);
    may_end.set_value();
    adding.get();
    CHECK(added == 6);
}

TEST_CASE("what frames hold is bounded, however long they take", "[scene][frames]")
{
    std::atomic<int> held = 0, most = 0;
    struct Copy {
        std::atomic<int>& held;
        Copy(std::atomic<int>& count, std::atomic<int>& max) : held(count) { max = std::max(max.load(), ++held); }
        ~Copy() { --held; }
        Copy(const Copy&) = delete;
        Copy& operator=(const Copy&) = delete;
    };
    FrameWriter writer(2);
    for (int frame = 0; frame < 30; ++frame)
        writer.add([copy = std::make_shared<Copy>(held, most)] { std::this_thread::sleep_for(1ms); });
    writer.wait();
    CHECK(held == 0);
    CHECK(most >= 2);
    CHECK(most <= 2 + 1 + 1); // waiting, being written, being added
}

TEST_CASE("the first frame that fails is the last, and its error comes out", "[scene][frames]")
{
    std::vector<int> called;
    std::promise<void> may_end;
    FrameWriter writer;
    for (int frame = 0; frame < 4; ++frame) {
        writer.add([&, frame] {
            if (frame == 0) may_end.get_future().wait(); // so that those behind the bad one are there already
            called.push_back(frame);
            if (frame == 1) throw OutputError("cannot write it");
        });
    }
    CHECK_NOTHROW(writer.check());
    may_end.set_value();
    writer.wait();
    CHECK(called == std::vector<int>{0, 1});
    CHECK_THROWS_WITH(writer.check(), "cannot write it");
    CHECK_THROWS_AS(writer.add([] {}), OutputError);
    CHECK_THROWS_AS(writer.check(), OutputError);
    writer.wait();
    CHECK(called.size() == 2);
}

TEST_CASE("a failure wakes an add that waits", "[scene][frames]")
{
    FrameWriter writer(1);
    const auto add_many = [&] {
        for (int frame = 0; frame < 5; ++frame)
            writer.add([] {
                std::this_thread::sleep_for(5ms);
                throw OutputError("full");
            });
    };
    CHECK_THROWS_WITH(add_many(), "full");
    CHECK_THROWS_AS(FrameWriter(0), std::invalid_argument);
}
