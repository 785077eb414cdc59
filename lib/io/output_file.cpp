#include "io/output_file.hpp"

#include "flotsam/io/output_error.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

namespace flotsam {

OutputFile::OutputFile(std::filesystem::path path, bool keep_if_unfinished)
    : path_(std::move(path)), keep_if_unfinished_(keep_if_unfinished)
{
    file_ = std::fopen(path_.c_str(), "wb");
    if (file_ == nullptr) fail(errno);
}

OutputFile::~OutputFile()
{
    if (file_ == nullptr) return;
    std::fclose(file_);
    std::error_code ignored;
    // A device (/dev/full, /dev/stdout, ...) is not ours to remove.
    if (!keep_if_unfinished_ && std::filesystem::is_regular_file(path_, ignored)) {
        std::filesystem::remove(path_, ignored);
    }
}

void OutputFile::write(const void* data, std::size_t bytes)
{
    if (bytes > 0 && std::fwrite(data, 1, bytes, file_) != bytes) fail(errno);
}

void OutputFile::flush()
{
    if (std::fflush(file_) != 0) fail(errno);
}

void OutputFile::close()
{
    flush();
    if (std::fclose(std::exchange(file_, nullptr)) != 0) fail(errno);
}

void OutputFile::fail(int error) const
{
    throw OutputError("cannot write " + path_.string() + ": " + std::generic_category().message(error));
}

} // namespace flotsam
