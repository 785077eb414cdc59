#include "io/vtp_file.hpp"

#include "io/output_file.hpp"

#include <bit>
#include <sstream>

namespace flotsam {

namespace {

/// Describes arrays while it counts where their bytes will stand in the appended block.
class Header {
  public:
    void array(const VtpArray& a)
    {
        text << "<DataArray type=\"" << a.type << "\" Name=\"" << a.name << "\" NumberOfComponents=\"" << a.components
             << "\" format=\"appended\" offset=\"" << offset_ << "\"/>\n";
        offset_ += sizeof(std::uint64_t) + a.bytes;
        appended.push_back(&a);
    }
    void section(std::string_view name, std::string_view attributes, std::span<const VtpArray> arrays)
    {
        text << '<' << name << attributes << ">\n";
        for (const VtpArray& a : arrays) array(a);
        text << "</" << name << ">\n";
    }

    std::ostringstream text;
    std::vector<const VtpArray*> appended;

  private:
    std::uint64_t offset_ = 0;
};

std::string attribute(std::string_view name, std::string_view value)
{
    return value.empty() ? std::string() : ' ' + std::string(name) + "=\"" + std::string(value) + '"';
}

} // namespace

void VtpFile::write(const std::filesystem::path& file) const
{
    const bool vertices = kind == Cells::vertices;
    const VtpArray topology[] = {connectivity, offsets};
    Header header;
    header.text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\""
                << (std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian")
                << "\" header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"" << points << "\" NumberOfVerts=\""
                << (vertices ? cells : 0) << "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\""
                << (vertices ? 0 : cells) << "\">\n";
    header.section("PointData", attribute("Scalars", point_scalars) + attribute("Vectors", point_vectors), point_data);
    header.section("CellData", "", cell_data);
    header.section("Points", "", {&positions, 1});
    header.section(vertices ? "Verts" : "Polys", "", topology);
    header.text << "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";

    OutputFile stream(file);
    stream.write(header.text.str());
    for (const VtpArray* a : header.appended) {
        const std::uint64_t bytes = a->bytes;
        stream.write(&bytes, sizeof bytes);
        stream.write(a->data, a->bytes);
    }
    stream.write("\n</AppendedData>\n</VTKFile>\n");
    stream.close();
}

} // namespace flotsam
