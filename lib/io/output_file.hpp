#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace flotsam {

/// A file being written, every step of it checked: a full disk shows only when buffers are flushed or closed.
/// Throws OutputError. A file that is not closed by close() is incomplete and is removed, unless keep_if_unfinished.
class OutputFile {
  public:
    explicit OutputFile(std::filesystem::path path, bool keep_if_unfinished = false);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* data, std::size_t bytes);
    void write(std::string_view text) { write(text.data(), text.size()); }
    void flush();
    void close();

  private:
    [[noreturn]] void fail(int error) const;

    std::filesystem::path path_;
    std::FILE* file_ = nullptr;
    bool keep_if_unfinished_;
};

} // namespace flotsam
