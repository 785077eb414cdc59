#pragma once

#include <assimp/DefaultIOStream.h>
#include <assimp/DefaultIOSystem.h>

#include <cstdio>
#include <set>
#include <string>

namespace flotsam {

/// Files for assimp that are closed in any case: some of its readers forget theirs when they give up on a bad file.
class AssimpFiles : public Assimp::DefaultIOSystem {
  public:
    AssimpFiles() = default;
    ~AssimpFiles() override
    {
        while (!open_.empty()) delete *open_.begin();
    }
    AssimpFiles(const AssimpFiles&) = delete;
    AssimpFiles& operator=(const AssimpFiles&) = delete;

    Assimp::IOStream* Open(const char* file, const char* mode) override
    {
        std::FILE* stream = std::fopen(file, mode);
        return stream != nullptr ? new Stream(stream, file, open_) : nullptr;
    }

  private:
    /// Readers either delete a stream or hand it to Close, which does.
    class Stream : public Assimp::DefaultIOStream {
      public:
        Stream(std::FILE* stream, const std::string& file, std::set<Stream*>& open)
            : DefaultIOStream(stream, file), open_(open)
        {
            open_.insert(this);
        }
        ~Stream() override { open_.erase(this); }
        Stream(const Stream&) = delete;
        Stream& operator=(const Stream&) = delete;

      private:
        std::set<Stream*>& open_;
    };

    std::set<Stream*> open_;
};

} // namespace flotsam
