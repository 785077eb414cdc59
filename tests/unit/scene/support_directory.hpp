#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace flotsam::testing {

/// A directory of its own for one test case, removed in the end.
class TemporaryDirectory {
  public:
    explicit TemporaryDirectory(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / (name + "_" + std::to_string(getpid())))
    {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryDirectory()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    void write(const std::string& file, const std::string& text) const { std::ofstream(path_ / file) << text; }
    [[nodiscard]] std::string read(const std::string& file) const
    {
        std::ifstream stream(path_ / file);
        std::ostringstream text;
        text << stream.rdbuf();
        return text.str();
    }

  private:
    std::filesystem::path path_;
};

} // namespace flotsam::testing
