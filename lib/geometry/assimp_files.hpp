#pragma once

#include <assimp/DefaultIOStream.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>

#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <utility>

namespace flotsam {

/// Files for assimp that are closed in any case: some of its readers forget theirs when they give up on a bad file.
/// One of them may have another content than the disk says.
class AssimpFiles : public Assimp::DefaultIOSystem {
  public:
    AssimpFiles(std::string replaced, std::string content)
        : replaced_(std::move(replaced)), content_(std::move(content))
    {
    }
    ~AssimpFiles() override
    {
        while (!open_.empty()) delete *open_.begin();
    }
    AssimpFiles(const AssimpFiles&) = delete;
    AssimpFiles& operator=(const AssimpFiles&) = delete;

    Assimp::IOStream* Open(const char* file, const char* mode) override
    {
        if (!content_.empty() && replaced_ == file)
            return new Stream<Assimp::MemoryIOStream>(open_, reinterpret_cast<const std::uint8_t*>(content_.data()),
                                                      content_.size());
        std::FILE* stream = std::fopen(file, mode);
        return stream != nullptr ? new Stream<DiskStream>(open_, stream, file) : nullptr;
    }

  private:
    struct DiskStream : Assimp::DefaultIOStream {
        DiskStream(std::FILE* stream, const std::string& file) : DefaultIOStream(stream, file) {}
    };

    /// Readers either delete a stream or hand it to Close, which does.
    template <class Base>
    class Stream : public Base {
      public:
        template <class... Arguments>
        explicit Stream(std::set<Assimp::IOStream*>& open, Arguments&&... arguments)
            : Base(std::forward<Arguments>(arguments)...), open_(open)
        {
            open_.insert(this);
        }
        ~Stream() override { open_.erase(this); }
        Stream(const Stream&) = delete;
        Stream& operator=(const Stream&) = delete;

      private:
        std::set<Assimp::IOStream*>& open_;
    };

    std::string replaced_;
    std::string content_;
    std::set<Assimp::IOStream*> open_;
};

} // namespace flotsam
