#include "mesh_files.hpp"
#include "words.hpp"

#include <algorithm>

namespace flotsam {

namespace {

std::string lower_case(std::string_view text)
{
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

/// Binary files may begin with "solid" too, but have zeros before long.
bool is_ascii_stl(std::string_view file)
{
    return lower_case(Words(file).next()) == "solid" && file.substr(0, 512).find('\0') == std::string_view::npos;
}

class AsciiStl {
  public:
    explicit AsciiStl(std::string_view file) : words_(file) {}

    std::string plain()
    {
        for (std::string word = next(); !word.empty(); word = next()) {
            expect(word, "solid");
            read_solid();
        }
        return std::move(plain_);
    }

  private:
    std::string next() { return lower_case(words_.next()); }

    [[noreturn]] void refuse_word(const std::string& word, const std::string& allowed) const
    {
        if (word.empty()) throw MeshFileFault("it is truncated: there is no \"endsolid\" at its end");
        throw MeshFileFault("it has " + in_quotes(word) + " " + on_line(words_.line()) + ", allowed is " + allowed);
    }

    void expect(const std::string& word, const std::string& allowed) const
    {
        if (word != allowed) refuse_word(word, allowed);
    }

    void read_solid()
    {
        const std::string name(Words(words_.rest_of_line()).next());
        plain_ += "solid " + name + "\n";
        for (std::string word = next(); word != "endsolid"; word = next()) {
            if (word != "facet") refuse_word(word, "facet or endsolid");
            read_facet();
        }
        (void)words_.rest_of_line(); // its name again
        plain_ += "endsolid\n";
    }

    void read_facet()
    {
        (void)words_.rest_of_line(); // the normal is taken from the corners
        expect(next(), "outer");
        expect(next(), "loop");
        plain_ += "facet normal 0 0 0\nouter loop\n";
        for (int corner = 0; corner < 3; ++corner) {
            expect(next(), "vertex");
            plain_ += "vertex";
            for (int axis = 0; axis < 3; ++axis) {
                const std::string word = next();
                if (!number_of(word)) refuse_word(word, "a number");
                plain_ += " " + word;
            }
            plain_ += "\n";
        }
        expect(next(), "endloop");
        expect(next(), "endfacet");
        plain_ += "endloop\nendfacet\n";
    }

    Words words_;
    std::string plain_;
};

} // namespace

std::string plain_stl(std::string_view file)
{
    constexpr std::size_t kHeader = 84;
    constexpr std::size_t kFacet = 50;
    std::uint32_t facets = 0; // little endian, as the format says
    for (std::size_t k = 0; k < 4 && file.size() >= kHeader; ++k)
        facets |= static_cast<std::uint32_t>(static_cast<unsigned char>(file[80 + k])) << (8 * k);
    const std::uint64_t announced = kHeader + kFacet * static_cast<std::uint64_t>(facets);
    if (file.size() >= kHeader && file.size() == announced) return std::string(file);
    if (is_ascii_stl(file)) return AsciiStl(file).plain();
    if (file.size() < kHeader) throw MeshFileFault("it is truncated: a binary STL file has at least 84 bytes");
    throw MeshFileFault("its header announces " + std::to_string(facets) + " triangles, which is a file of " +
                        std::to_string(announced) + " bytes, but it has " + std::to_string(file.size()));
}

} // namespace flotsam
