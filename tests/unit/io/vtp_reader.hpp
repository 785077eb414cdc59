#pragma once

#include "unit/io/scratch.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

/// Reads .vtp files with raw appended data as strictly as VTK's own reader: every array's offset must point at its byte
/// count, the arrays must fill the appended block without a gap, tags must be balanced.
class VtpReader {
  public:
    explicit VtpReader(const std::filesystem::path& file) : text_(contents(file))
    {
        const std::string marker = "<AppendedData encoding=\"raw\">\n_";
        const std::size_t data = text_.find(marker);
        expect(data != std::string::npos, "appended data");
        begin_ = data + marker.size();
        header_ = text_.substr(0, data);
        read_tags();
        const std::string tail = "\n</AppendedData>\n</VTKFile>\n";
        expect(text_.compare(begin_ + end_, std::string::npos, tail) == 0, "the end right after the last array");
    }

    struct Array {
        std::string section, type;
        std::size_t components, offset, bytes;
    };
    using Attributes = std::map<std::string, std::string>;

    [[nodiscard]] const Attributes& tag(const std::string& name) const { return tags_.at(name); }
    [[nodiscard]] std::size_t count(const std::string& what) const
    {
        return std::stoul(tag("Piece").at("NumberOf" + what));
    }
    [[nodiscard]] const Array& array(const std::string& name) const { return arrays_.at(name); }

    template <class T>
    [[nodiscard]] std::vector<T> values(const std::string& name) const
    {
        const Array& a = arrays_.at(name);
        const std::string kind = std::is_floating_point_v<T> ? "Float" : std::is_signed_v<T> ? "Int" : "UInt";
        expect(a.type == kind + std::to_string(8 * sizeof(T)), "type of " + name);
        std::vector<T> result(a.bytes / sizeof(T));
        if (a.bytes > 0) std::memcpy(result.data(), text_.data() + begin_ + a.offset + 8, a.bytes);
        return result;
    }

  private:
    static void expect(bool condition, const std::string& what)
    {
        if (!condition) throw std::runtime_error("expected " + what);
    }

    static Attributes attributes(const std::string& inside)
    {
        Attributes result;
        for (std::size_t at = inside.find('='); at != std::string::npos; at = inside.find('=', at + 1)) {
            const std::size_t name = inside.rfind(' ', at) + 1;
            const std::size_t end = inside.find('"', at + 2);
            expect(inside[at + 1] == '"' && end != std::string::npos, "quoted attributes");
            result[inside.substr(name, at - name)] = inside.substr(at + 2, end - at - 2);
            at = end;
        }
        return result;
    }

    void read_tags()
    {
        std::vector<std::string> open;
        for (std::size_t at = header_.find('<'); at != std::string::npos; at = header_.find('<', at + 1)) {
            const std::string inside = header_.substr(at + 1, header_.find('>', at) - at - 1);
            if (inside[0] == '?') continue;
            if (inside[0] == '/') {
                expect(!open.empty() && open.back() == inside.substr(1), "balanced tags");
                open.pop_back();
                continue;
            }
            const std::string name = inside.substr(0, inside.find_first_of(" /"));
            tags_[name] = attributes(inside);
            if (name == "DataArray") add_array(open.back(), tags_[name]);
            if (inside.back() != '/') open.push_back(name);
        }
        expect(open == std::vector<std::string>{"VTKFile"}, "only VTKFile open before the appended data");
    }

    void add_array(const std::string& section, const Attributes& a)
    {
        const std::size_t offset = std::stoul(a.at("offset"));
        expect(a.at("format") == "appended" && offset == end_, "arrays one after the other");
        std::uint64_t bytes = 0;
        std::memcpy(&bytes, text_.data() + begin_ + offset, sizeof bytes);
        end_ = offset + sizeof bytes + bytes;
        expect(begin_ + end_ <= text_.size(), "all bytes of " + a.at("Name"));
        arrays_[a.at("Name")] = {section, a.at("type"), std::stoul(a.at("NumberOfComponents")), offset, bytes};
    }

    std::string text_, header_;
    std::size_t begin_ = 0; ///< of the appended block
    std::size_t end_ = 0;   ///< of the last array read, from begin_
    std::map<std::string, Attributes> tags_;
    std::map<std::string, Array> arrays_;
};
