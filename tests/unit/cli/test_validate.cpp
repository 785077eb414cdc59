#include "run_program.hpp"
#include "support/catch.hpp"

using namespace flotsam::testing;

TEST_CASE("validate runs the cases that are named and writes a table and a page", "[cli][validate]")
{
    const TemporaryDirectory directory("flotsam_cli_validate");
    const Outcome done = run_program(directory, "validate patch_impact elliptic_drop --quick --out out --threads 2");
    INFO(done.out << done.err);
    CHECK(done.code == 0);
    CHECK(contains(done.out, "patch_impact: A rectangle of water meets a wall"));
    CHECK(contains(done.out, "9 of 9 checks lie inside their bands"));
    CHECK_FALSE(contains(done.out, "drafts"));
    CHECK(std::filesystem::exists(directory.path() / "out" / "validation.csv"));
    CHECK(std::filesystem::exists(directory.path() / "out" / "report.html"));
}

TEST_CASE("validate refuses cases that there are none of, and files in the place of its directory", "[cli][validate]")
{
    const TemporaryDirectory directory("flotsam_cli_validate_bad");
    directory.write("file", "");
    for (const char* arguments : {"validate patch_impact sinking --out out", "validate patch_impact --out file",
                                  "validate --threads 0", "validate --fast", "validate --out ''"}) {
        const Outcome refused = run_program(directory, arguments);
        INFO(arguments << ": " << refused.out << refused.err);
        CHECK(refused.code == 2);
        CHECK(refused.out.empty());
        CHECK(refused.err.rfind("error: ", 0) == 0);
    }
    const std::string names = run_program(directory, "validate sinking").err;
    CHECK(contains(names, "there is no validation case \"sinking\"; there are "));
    CHECK(contains(names, "square_log, "));
}

TEST_CASE("a validation case that cannot be run is named", "[cli][validate]")
{
    const TemporaryDirectory directory("flotsam_cli_validate_failed");
    const Outcome failed = run_program(directory, "validate square_log --quick --out out", "TMPDIR=/nowhere/at/all");
    INFO(failed.out << failed.err);
    CHECK(failed.code == 1);
    CHECK(failed.err.rfind("error: validation case square_log: ", 0) == 0);
}
