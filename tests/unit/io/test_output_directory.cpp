#include "support/catch.hpp"

#include "flotsam/core/contracts.hpp"
#include "flotsam/io/output_directory.hpp"
#include "flotsam/io/output_error.hpp"
#include "unit/io/scratch.hpp"

using namespace flotsam;
namespace fs = std::filesystem;

namespace {

const std::string kReport = R"({"version": "0.1.0", "particles": {"fluid": 1}, "steps": 3})";

void make_older_output(const fs::path& directory)
{
    fs::create_directories(directory / "pictures");
    put(directory / "report.json", kReport);
    put(directory / "pictures" / "0.vtp", "old");
}

} // namespace

TEST_CASE("an output directory appears on commit and not before", "[io][output]")
{
    const Scratch scratch;
    const fs::path target = scratch / "out/run1/"; // parents are made, the slash at the end is no name
    {
        OutputDirectory out(target);
        CHECK(out.target() == fs::weakly_canonical(scratch / "out/run1"));
        put(out.path() / "report.json", kReport);
        CHECK_FALSE(fs::exists(target));
        out.commit();
        CHECK(out.path() == out.target());
    }
    CHECK(contents(scratch / "out/run1/report.json") == kReport);
    CHECK(std::distance(fs::directory_iterator(scratch / "out"), {}) == 1);
}

TEST_CASE("an output directory without commit leaves nothing behind", "[io][output]")
{
    const Scratch scratch;
    {
        OutputDirectory out(scratch / "a/b/out");
        put(out.path() / "frame.png", "half");
        CHECK(fs::exists(out.path() / "frame.png"));
    }
    CHECK(scratch.entries() == 0);
}

TEST_CASE("an older output is replaced whole, and only on commit", "[io][output]")
{
    const Scratch scratch;
    make_older_output(scratch / "out");
    {
        const OutputDirectory refused(scratch / "out");
    }
    CHECK(contents(scratch / "out/pictures/0.vtp") == "old");
    {
        OutputDirectory out(scratch / "out");
        put(out.path() / "report.json", "new");
        CHECK(contents(scratch / "out/report.json") == kReport);
        out.commit();
    }
    CHECK(contents(scratch / "out/report.json") == "new");
    CHECK_FALSE(fs::exists(scratch / "out/pictures"));
    CHECK(scratch.entries() == 1);
}

TEST_CASE("an older table of hydrostatics is replaced by another one, not by a run", "[io][output]")
{
    const Scratch scratch;
    const auto table = [&] { return OutputDirectory(scratch / "out", OutputKind::hydrostatics); };
    fs::create_directory(scratch / "out");
    put(scratch / "out/hydrostatics.json", R"({"version": "0.1.0", "mesh": "a.obj"})");
    CHECK_THROWS_AS(table(), InputError); // not all that ours has
    put(scratch / "out/hydrostatics.json", R"({"version": "0.1.0", "mesh": "a.obj", "stable_poses": []})");
    CHECK_THROWS_WITH(OutputDirectory(scratch / "out"), Catch::Contains("something else"));
    put(scratch / "out/poses.csv", "old");
    OutputDirectory out(scratch / "out", OutputKind::hydrostatics);
    put(out.path() / "hydrostatics.json", "new");
    out.commit();
    CHECK(contents(scratch / "out/hydrostatics.json") == "new");
    CHECK_FALSE(fs::exists(scratch / "out/poses.csv"));
}

TEST_CASE("what somebody has put beside an output of ours is not lost", "[io][output]")
{
    const Scratch scratch;
    make_older_output(scratch / "out");
    put(scratch / "out/notes.txt", "years of work");
    CHECK_THROWS_WITH(OutputDirectory(scratch / "out"), Catch::Contains("out holds notes.txt beside"));
    fs::rename(scratch / "out/notes.txt", scratch / "notes.txt");
    OutputDirectory out(scratch / "out");
    put(scratch / "out/scene.json", "{}"); // while we ran
    CHECK_THROWS_WITH(out.commit(), Catch::Contains("scene.json"));
    CHECK(contents(scratch / "out/pictures/0.vtp") == "old");
}

TEST_CASE("an empty directory is taken", "[io][output]")
{
    const Scratch scratch;
    fs::create_directory(scratch / "out");
    OutputDirectory out(scratch / "out");
    put(out.path() / "a", "1");
    out.commit();
    CHECK(contents(scratch / "out/a") == "1");
}

TEST_CASE("directories and files of others are not touched", "[io][output]")
{
    const Scratch scratch;
    fs::create_directory(scratch / "home");
    put(scratch / "home/thesis.tex", "years of work");
    SECTION("no report")
    {
        CHECK_THROWS_AS(OutputDirectory(scratch / "home"), InputError);
        CHECK_THROWS_WITH(OutputDirectory(scratch / "home"), Catch::Contains("home holds something else"));
    }
    SECTION("another program's report")
    {
        put(scratch / "home/report.json", R"({"tests": 12})");
        CHECK_THROWS_AS(OutputDirectory(scratch / "home"), InputError);
    }
    SECTION("a report that is not JSON")
    {
        put(scratch / "home/report.json", "{\"version\":");
        CHECK_THROWS_AS(OutputDirectory(scratch / "home"), InputError);
    }
    SECTION("a file")
    {
        CHECK_THROWS_WITH(OutputDirectory(scratch / "home/thesis.tex"), Catch::Contains("thesis.tex is a file"));
    }
    SECTION("filled by another while we ran")
    {
        fs::remove(scratch / "home/thesis.tex");
        {
            OutputDirectory out(scratch / "home");
            put(scratch / "home/thesis.tex", "years of work");
            CHECK_THROWS_AS(out.commit(), InputError);
        }
    }
    CHECK(contents(scratch / "home/thesis.tex") == "years of work");
    CHECK(scratch.entries() == 1);
}

TEST_CASE("a target that cannot be made is refused in a sentence", "[io][output]")
{
    const Scratch scratch;
    put(scratch / "file", "");
    CHECK_THROWS_AS(OutputDirectory(""), InputError);
    CHECK_THROWS_AS(OutputDirectory("/"), InputError);
    CHECK_THROWS_AS(OutputDirectory(scratch / "file/out"), InputError);
    CHECK_THROWS_WITH(OutputDirectory(scratch / "file/out"), Catch::Contains("file/out: Not a directory"));
    CHECK_THROWS_AS(OutputDirectory("/proc/out"), InputError);                     // nobody may write there
    CHECK_THROWS_AS(OutputDirectory(scratch / std::string(300, 'x')), InputError); // longer than names can be
    CHECK(scratch.entries() == 1);
    fs::create_symlink("nowhere", scratch / "link");
    CHECK_THROWS_WITH(OutputDirectory(scratch / "link"), Catch::Contains("is a link to nothing"));
}

TEST_CASE("a run that fails half-way can keep its frames", "[io][output]")
{
    const Scratch scratch;
    make_older_output(scratch / "out");
    fs::path first;
    fs::path second;
    {
        OutputDirectory out(scratch / "out");
        put(out.path() / "frame", "1");
        first = out.keep_partial();
    }
    {
        OutputDirectory out(scratch / "out");
        put(out.path() / "frame", "2");
        second = out.keep_partial();
    }
    CHECK(first == fs::weakly_canonical(scratch / "out.partial"));
    CHECK(contents(first / "frame") == "1"); // and the second took another name
    CHECK(contents(second / "frame") == "2");
    CHECK(contents(scratch / "out/report.json") == kReport);
}

TEST_CASE("two runs into one target do not meet", "[io][output]")
{
    const Scratch scratch;
    OutputDirectory a(scratch / "out");
    OutputDirectory b(scratch / "out");
    REQUIRE(a.path() != b.path());
    put(a.path() / "report.json", kReport);
    put(b.path() / "report.json", kReport + "\n");
    a.commit();
    b.commit();
    CHECK(contents(scratch / "out/report.json") == kReport + "\n");
    CHECK(scratch.entries() == 1);
}

TEST_CASE("a text is replaced whole or not at all", "[io][output]")
{
    const Scratch scratch;
    write_text_atomically(scratch / "a.json", "one");
    write_text_atomically(scratch / "a.json", "two");
    CHECK(contents(scratch / "a.json") == "two");
    CHECK(scratch.entries() == 1);

    fs::create_symlink("/dev/full", scratch / "a.json.partial");
    CHECK_THROWS_WITH(write_text_atomically(scratch / "a.json", "three"), Catch::Contains("No space left on device"));
    CHECK(contents(scratch / "a.json") == "two");
    CHECK_THROWS_AS(write_text_atomically(scratch / "none/a.json", ""), OutputError);
}
