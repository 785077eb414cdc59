#include "support/catch.hpp"

#include "flotsam/io/csv.hpp"
#include "flotsam/io/output_error.hpp"
#include "unit/io/scratch.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

using namespace flotsam;

TEST_CASE("a table reads back to nine digits", "[io][csv]")
{
    const Scratch scratch;
    const std::array<std::string, 4> columns = {"t", "crate.x", "a,b", "said \"so\""};
    const std::array<double, 4> values = {0.1, -1.0 / 3.0, 1e-300, 123456789.0};
    {
        CsvWriter table(scratch / "t.csv", columns);
        table.row(values);
        table.row(std::array{1.0, std::numeric_limits<double>::quiet_NaN(), -0.0, 1e21});
        table.close();
    }
    std::istringstream lines(contents(scratch / "t.csv"));
    std::string line;
    std::getline(lines, line);
    CHECK(line == "t,crate.x,\"a,b\",\"said \"\"so\"\"\"");
    std::getline(lines, line);
    CHECK(line == "0.1,-0.333333333,1e-300,123456789");
    std::getline(lines, line);
    CHECK(line == "1,nan,-0,1e+21");
    CHECK_FALSE(std::getline(lines, line));
}

TEST_CASE("cells of a table are quoted where they must be", "[io][csv]")
{
    CHECK(csv_cell("crate.x, no") == "\"crate.x, no\"");
    CHECK(csv_cell("said \"so\"") == "\"said \"\"so\"\"\"");
    CHECK(csv_cell("two\nlines") == "\"two\nlines\"");
    for (const char* plain : {"", "crate.x", "angle [deg]; 1.5"}) CHECK(csv_cell(plain) == plain);
}

TEST_CASE("each row is on disk as soon as it is written", "[io][csv]")
{
    const Scratch scratch;
    const std::array<std::string, 1> columns = {"t"};
    CsvWriter table(scratch / "t.csv", columns);
    CHECK(contents(scratch / "t.csv") == "t\n");
    table.row(std::array{2.5});
    CHECK(contents(scratch / "t.csv") == "t\n2.5\n");
}

TEST_CASE("a table refuses rows of another length", "[io][csv]")
{
    const Scratch scratch;
    const std::array<std::string, 2> columns = {"a", "b"};
    CsvWriter table(scratch / "t.csv", columns);
    CHECK_THROWS_AS(table.row(std::array{1.0}), std::invalid_argument);
    CHECK_THROWS_AS(CsvWriter(scratch / "none.csv", {}), std::invalid_argument);
    table.close();
    CHECK_THROWS_AS(table.row(std::array{1.0, 2.0}), std::invalid_argument);
}

TEST_CASE("a table on a full disk says so", "[io][csv]")
{
    const std::array<std::string, 1> columns = {"t"};
    CHECK_THROWS_WITH(CsvWriter("/dev/full", columns), "cannot write /dev/full: No space left on device");
    CHECK_THROWS_AS(CsvWriter("/nowhere/at/all.csv", columns), OutputError);
}
