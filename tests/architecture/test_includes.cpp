#include "architecture/includes.hpp"
#include "support/catch.hpp"

#include <fstream>

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sources_below(const fs::path& folder)
{
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".hpp" || entry.path().extension() == ".cpp") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

std::string contents(const fs::path& file)
{
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

} // namespace

TEST_CASE("arrows between modules follow the table", "[architecture]")
{
    const fs::path root = FLOTSAM_SOURCE_DIR;
    std::vector<fs::path> files = sources_below(root / "include");
    const std::vector<fs::path> sources = sources_below(root / "lib");
    files.insert(files.end(), sources.begin(), sources.end());
    REQUIRE(files.size() > 20);

    std::string all;
    for (const fs::path& file : files)
        for (const std::string& violation : architecture::violations(fs::relative(file, root), contents(file)))
            all += violation + '\n';
    CHECK(all == "");
}

TEST_CASE("the table points downward only", "[architecture]")
{
    for (const architecture::Module& module : architecture::table())
        for (const std::string& name : module.may_include) {
            INFO(module.name << " -> " << name);
            const architecture::Module* target = architecture::find_module(name);
            REQUIRE(target != nullptr);
            CHECK(target->floor < module.floor);
        }
}

TEST_CASE("an arrow against the table is found", "[architecture]")
{
    struct Sample {
        const char *file, *line;
        bool allowed;
    };
    const auto [file, line, allowed] = GENERATE(values<Sample>({
        {"lib/geometry/a.cpp", "#include \"flotsam/core/types.hpp\"", true},
        {"lib/geometry/a.cpp", "#include \"flotsam/sph/fluid_state.hpp\"", false}, // same floor
        {"lib/geometry/a.cpp", "#include \"flotsam/world/bodies.hpp\"", false},    // upward
        {"lib/world/a.cpp", "#include \"geometry/private.hpp\"", true},            // a private header below
        {"lib/sph/a.cpp", "#include \"geometry/private.hpp\"", false},             // a private header beside
        {"lib/sph/a.cpp", "#include \"pressure/operator.hpp\"", true},             // a folder of its own
        {"lib/sph/a.cpp", "#include \"../geometry/private.hpp\"", false},          // hidden by ..
        {"lib/world/a.cpp", "  #  include \"flotsam/bullet/bullet_coupling.hpp\"", false},
        {"lib/world/a.cpp", "#include <btBulletDynamicsCommon.h>", false},
        {"lib/bullet/a.cpp", "#include <BulletDynamics/Dynamics/btRigidBody.h>", true},
        {"lib/scene/a.cpp", "#include \"flotsam/bullet.hpp\"", true},
        {"lib/world/a.cpp", "#include \"flotsam/flotsam.hpp\"", false},
        {"lib/io/a.cpp", "#include <embree3/rtcore.h>", true},
        {"lib/scene/a.cpp", "#include <embree3/rtcore.h>", false},
        {"lib/io/a.cpp", "#include \"flotsam/scene/scene.hpp\"", false},
        {"lib/geometry/a.cpp", "#include <fcl/fcl.h>", true},
        {"lib/world/a.cpp", "#include <fcl/fcl.h>", false},
        {"lib/core/a.cpp", "#include <tbb/parallel_for.h>", true},
        {"lib/sph/a.cpp", "#include <tbb/parallel_for.h>", false},
        {"lib/io/a.cpp", "#include <boost/any.hpp>", false}, // no library of the table
        {"lib/scene/a.cpp", "#include <CLI/CLI.hpp>", false},
        {"lib/cli/main.cpp", "#include <CLI/CLI.hpp>", true},
        {"lib/cli/main.cpp", "#include <unistd.h>", true},
        {"lib/extras/a.cpp", "#include <vector>", false}, // no such module
        {"include/flotsam/core/a.hpp", "#include <Eigen/Core>", true},
        {"include/flotsam/core/a.hpp", "#include <tbb/parallel_for.h>", false}, // sources only
        {"include/flotsam/core/a.hpp", "#include <unistd.h>", false},
        {"include/flotsam/io/a.hpp", "#include <nlohmann/json.hpp>", false},
        {"include/flotsam/bullet/a.hpp", "#include <btBulletDynamicsCommon.h>", true},
        {"include/flotsam/scene/a.hpp", "#include <btBulletDynamicsCommon.h>", false},
        {"include/flotsam/world/a.hpp", "#include \"world/private.hpp\"", false}, // not installed
        {"include/flotsam/flotsam.hpp", "#include \"flotsam/bullet/bullet_coupling.hpp\"", false},
        {"include/flotsam/bullet.hpp", "#include \"flotsam/flotsam.hpp\"", true},
    }));
    INFO(file << ": " << line);
    CHECK(architecture::violations(file, std::string("// a comment\n") + line + " // why\n").empty() == allowed);
}
