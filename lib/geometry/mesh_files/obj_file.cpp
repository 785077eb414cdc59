#include "mesh_files.hpp"
#include "words.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace flotsam {

namespace {

/// One statement: a line, or several that a backslash joins.
struct Statement {
    std::size_t line = 0; ///< its first
    std::string text;     ///< without comment
};

class Statements {
  public:
    explicit Statements(std::string_view file) : rest_(file) {}

    bool next(Statement& statement)
    {
        statement.text.clear();
        if (rest_.empty()) return false;
        statement.line = line_ + 1;
        while (take_line(statement.text)) {
        }
        statement.text.resize(std::min(statement.text.find('#'), statement.text.size()));
        return true;
    }

  private:
    /// Appends a line; says whether one more belongs to it.
    bool take_line(std::string& text)
    {
        const std::size_t end = std::min(rest_.find('\n'), rest_.size());
        std::string_view line = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        ++line_;
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        const bool goes_on = !line.empty() && line.back() == '\\';
        if (goes_on) line.remove_suffix(1);
        text += line;
        if (goes_on) text += ' ';
        return goes_on && !rest_.empty();
    }

    std::string_view rest_;
    std::size_t line_ = 0;
};

/// How many v, vt and vn statements there are.
using Counts = std::array<std::int64_t, 3>;

constexpr std::array<std::string_view, 3> kPoints{"v", "vt", "vn"};

void count_point(std::string_view keyword, Counts& counts)
{
    for (std::size_t kind = 0; kind < 3; ++kind) counts[kind] += keyword == kPoints[kind] ? 1 : 0;
}

class ObjReader {
  public:
    explicit ObjReader(std::string_view file) : file_(file) {}

    std::string plain()
    {
        Statement statement;
        for (Statements all(file_); all.next(statement);) count_point(Words(statement.text).next(), total_);
        for (Statements all(file_); all.next(statement);) add(statement);
        if (!has_faces_) throw MeshFileFault("it has no triangles");
        return std::move(plain_);
    }

  private:
    void add(const Statement& statement)
    {
        Words words(statement.text);
        const std::string_view keyword = words.next();
        count_point(keyword, so_far_);
        if (keyword == "v") add_vertex(words, statement.line);
        if (keyword == "f" || keyword == "fo") add_face(words, statement.line); // fo: old for f
        if (keyword == "o" || keyword == "g" || keyword == "usemtl") {
            std::string_view name = words.rest_of_line();
            name.remove_prefix(std::min(name.find_first_not_of(" \t"), name.size()));
            name = name.substr(0, name.find_last_not_of(" \t") + 1);
            if (name.empty() && keyword == "g") name = "default"; // as the format says
            if (!name.empty()) plain_ += std::string(keyword) + " " + std::string(name) + "\n";
        }
    }

    void add_vertex(Words& words, std::size_t line)
    {
        std::vector<std::string_view> numbers;
        for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
            if (!number_of(word))
                throw MeshFileFault("its vertex " + on_line(line) + " has " + in_quotes(word) + ", which is no number");
            numbers.push_back(word);
        }
        // A fourth number alone is a weight; colours come as three or four more.
        if (numbers.size() != 3 && numbers.size() != 4 && numbers.size() != 6 && numbers.size() != 7)
            throw MeshFileFault("its vertex " + on_line(line) + " has " + std::to_string(numbers.size()) +
                                " numbers, allowed are x, y and z");
        plain_ += "v";
        for (std::size_t k = 0; k < (numbers.size() == 4 ? 4U : 3U); ++k)
            plain_ +=
                (numbers[k].front() == '.' ? " 0" : " ") + std::string(numbers[k]); // assimp drops vertices with .5
        plain_ += "\n";
    }

    void add_face(Words& words, std::size_t line)
    {
        has_faces_ = true;
        plain_ += "f";
        int corners = 0;
        for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++corners)
            plain_ += " " + std::to_string(vertex_of_corner(word, line));
        plain_ += "\n";
        if (corners < 3)
            throw MeshFileFault("its face " + on_line(line) + " has " + std::to_string(corners) +
                                " corners, at least 3 are needed");
    }

    /// The corner "5/7/3" has vertex 5; all three are checked.
    std::int64_t vertex_of_corner(std::string_view corner, std::size_t line) const
    {
        std::int64_t vertex = 0;
        std::string_view rest = corner;
        for (std::size_t kind = 0; kind < 3; ++kind) {
            const std::size_t slash = std::min(rest.find('/'), rest.size());
            const std::string_view number = rest.substr(0, slash);
            const bool is_last = slash == rest.size();
            rest.remove_prefix(std::min(slash + 1, rest.size()));
            if (kind == 0 || !number.empty()) {
                const std::int64_t index = index_of(number, kind, corner, line);
                if (kind == 0) vertex = index;
            }
            if (is_last) return vertex;
        }
        throw MeshFileFault("its face " + on_line(line) + " has the corner " + in_quotes(corner) +
                            ", allowed are up to three numbers between slashes");
    }

    std::int64_t index_of(std::string_view number, std::size_t kind, std::string_view corner, std::size_t line) const
    {
        static constexpr std::array<std::string_view, 3> kNames{"vertex", "texture coordinate", "normal"};
        const auto given = whole_number_of(number);
        if (!given)
            throw MeshFileFault("its face " + on_line(line) + " has the corner " + in_quotes(corner) +
                                ", which is not made of whole numbers");
        const std::int64_t index = *given < 0 ? so_far_[kind] + 1 + *given : *given; // -1: the last one before the face
        if (index < 1 || index > total_[kind])
            throw MeshFileFault("its face " + on_line(line) + " names " + std::string(kNames[kind]) + " " +
                                std::to_string(*given) + ", allowed are " +
                                (total_[kind] > 0 ? "1 to " + std::to_string(total_[kind]) : "none, for it has none"));
        return index;
    }

    std::string_view file_;
    Counts total_{};
    Counts so_far_{};
    bool has_faces_ = false;
    std::string plain_;
};

} // namespace

std::string plain_obj(std::string_view file)
{
    return ObjReader(file).plain();
}

} // namespace flotsam
