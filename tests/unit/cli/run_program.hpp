#pragma once

#include "../scene/support_directory.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <string>

namespace flotsam::testing {

struct Outcome {
    int code = -1;
    std::string out, err;
};

/// Runs the program in a directory of its own, with `environment` ("NAME=value") besides what there is.
inline Outcome run_program(const TemporaryDirectory& directory, const std::string& arguments,
                           const std::string& environment = "")
{
    const std::string command = "cd '" + directory.path().string() + "' && " + environment + " '" FLOTSAM_PROGRAM "' " +
                                arguments + " >stdout.txt 2>stderr.txt </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, directory.read("stdout.txt"), directory.read("stderr.txt")};
}

inline bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

} // namespace flotsam::testing
