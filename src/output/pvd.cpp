#include "output/pvd.hpp"

#include <string>
#include <string_view>

#include "base/errors.hpp"
#include "output/numbers.hpp"
#include "output/pieces.hpp"
#include "output/whole_file.hpp"
#include "output/xml_tags.hpp"

namespace barchan {

std::vector<SeriesWriter::Entry> parse_pvd(std::string_view text) {
  std::vector<SeriesWriter::Entry> entries;
  XmlTags tags(text);
  XmlTags::Tag tag;
  bool collection = false, ended = false;
  while (tags.next(tag)) {
    if (tag.name == "Collection") collection = true;
    if (tag.name == "/VTKFile") ended = true;
    if (tag.name != "DataSet") continue;
    const auto file = tag.attributes.find("file"), time = tag.attributes.find("timestep");
    if (file == tag.attributes.end() || time == tag.attributes.end())
      tags.fail("a DataSet needs 'timestep' and 'file'");
    const auto value = parse_number(time->second);
    if (!value) tags.fail("timestep=\"" + time->second + "\" is not a number");
    if (!is_below_its_list(file->second))
      tags.fail("file=\"" + file->second + "\" is not a file below the folder of the list");
    entries.push_back({*value, file->second});
  }
  if (!collection || !ended) throw OutputError("it is not a whole .pvd file (a VTKFile with a Collection)");
  return entries;
}

void write_pvd(const std::filesystem::path& pvd, const std::vector<SeriesWriter::Entry>& entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const auto& [time, file] : entries)
    text += "    <DataSet timestep=\"" + exact(time) + "\" group=\"\" part=\"0\" file=\"" + escape(file) + "\"/>\n";
  text += "  </Collection>\n</VTKFile>\n";
  write_whole_file(pvd, text);
}

std::vector<SeriesWriter::Entry> read_pvd(const std::filesystem::path& pvd) {
  const std::string text = read_text(pvd);
  try {
    return parse_pvd(text);
  } catch (const OutputError& e) { throw OutputError("cannot read '" + pvd.string() + "': " + e.what()); }
}

}  // namespace barchan
