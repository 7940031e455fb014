#include "start/mesh_texts.hpp"

#include "scene/text_table.hpp"
#include "start/mesh_parts.hpp"

namespace barchan {

using namespace mesh;

namespace {

// --- .stl ------------------------------------------------------------------------------------------------------------

/// The line's words have to begin with these; more of them may follow only behind "solid" and "endsolid".
std::vector<std::string_view> stl_line(Lines& lines, std::string_view expected, std::size_t count) {
  if (!lines.next_with_words()) refuse("the file ends where \"" + std::string(expected) + "\" is expected");
  auto words = split_words(lines.line());
  const auto wanted = split_words(expected);
  bool good = words.size() == count;
  for (std::size_t k = 0; good && k < wanted.size(); ++k) good = same(words[k], wanted[k]);
  if (!good) refuse_line(lines.number(), "is not what is expected there: " + std::string(expected));
  return words;
}

void stl_text(std::string_view text, Mesh& mesh) {
  Lines lines(text);
  bool inside = false;
  while (lines.next_with_words()) {
    const auto words = split_words(lines.line());
    if (!inside) {
      if (!same(words[0], "solid")) refuse_line(lines.number(), "is not what is expected there: solid");
      inside = true;
    } else if (same(words[0], "endsolid")) {
      inside = false;
    } else {
      if (words.size() != 5 || !same(words[0], "facet") || !same(words[1], "normal"))
        refuse_line(lines.number(), "is not what is expected there: facet normal X Y Z, or endsolid");
      point_of(words, 2, lines.number());
      stl_line(lines, "outer loop", 2);
      Facet facet;
      for (Vec3& corner : facet) {
        const auto vertex = stl_line(lines, "vertex", 4);
        corner = point_of(vertex, 1, lines.number());
      }
      stl_line(lines, "endloop", 1);
      stl_line(lines, "endfacet", 1);
      mesh.triangles.push_back(facet);
    }
  }
  if (inside) refuse("the file ends before \"endsolid\"");
}

void stl_binary(std::string_view bytes, Mesh& mesh) {
  constexpr std::size_t head = 84, size = 50;
  if (bytes.size() < head) refuse("is neither the text nor the binary form of .stl");
  const std::size_t count = bytes_as<std::uint32_t>(bytes.data() + 80, false);
  if (bytes.size() != head + size * count)
    refuse("says that it has " + std::to_string(count) + " triangles, " + std::to_string(head + size * count) +
           " bytes, and has " + std::to_string(bytes.size()) + " bytes");
  for (std::size_t k = 0; k < count; ++k) {
    Facet facet;
    for (std::size_t i = 0; i < 9; ++i) {
      const double value = bytes_as<float>(bytes.data() + head + size * k + 12 + 4 * i, false);
      if (!std::isfinite(value)) refuse("triangle " + std::to_string(k) + " has a coordinate that is not finite");
      facet[i / 3][i % 3] = value;
    }
    mesh.triangles.push_back(facet);
  }
}

// --- .obj ------------------------------------------------------------------------------------------------------------

/// The number from 0 of the vertex that a word such as 7, -1, 7/2, 7//3 or 7/2/3 means. `counts`: of v, vt and vn.
std::size_t obj_vertex(std::string_view word, const std::array<std::size_t, 3>& counts, std::size_t line) {
  std::size_t vertex = 0, part = 0;
  for (std::string_view left = word;; ++part) {
    const std::size_t slash = left.find('/');
    const std::string_view text = left.substr(0, slash);
    if (!text.empty() || part == 0 || slash == std::string_view::npos) {
      const auto number = number_of<long>(text);
      if (part > 2 || !number) refuse_line(line, "has " + in_quotes(word) + " where a vertex is expected");
      const auto count = static_cast<long>(counts[part]);
      if (*number == 0 || *number > count || *number < -count)
        refuse_line(line, "names " +
                              std::string(part == 0   ? "vertex "
                                          : part == 1 ? "texture vertex "
                                                      : "normal ") +
                              std::to_string(*number) + " of " + std::to_string(count));
      if (part == 0) vertex = static_cast<std::size_t>(*number > 0 ? *number - 1 : count + *number);
    }
    if (slash == std::string_view::npos) return vertex;
    left.remove_prefix(slash + 1);
  }
}

void obj_numbers(const std::vector<std::string_view>& words, std::size_t least, std::size_t most, std::size_t line) {
  if (words.size() < least + 1 || words.size() > most + 1)
    refuse_line(line, "has " + std::to_string(words.size() - 1) + " numbers behind " + in_quotes(words[0]));
  for (std::size_t k = 1; k < words.size(); ++k)
    if (!coordinate_of(words[k])) refuse_line(line, "has " + in_quotes(words[k]) + " where a number is expected");
}

void obj(std::string_view text, Mesh& mesh) {
  static constexpr std::string_view passed[] = {"p",         "g",     "o",        "s",       "mg",         "usemtl",
                                                "mtllib",    "vp",    "usemap",   "maplib",  "shadow_obj", "lod",
                                                "trace_obj", "bevel", "c_interp", "d_interp"};
  std::vector<Vec3> points;
  std::array<std::size_t, 3> counts{};
  Lines lines(text);
  std::string joined;
  while (lines.next()) {
    std::string_view line = lines.line();
    if (line.ends_with('\\')) {  // the line goes on in the next one
      joined.clear();
      while (line.ends_with('\\')) {
        joined.append(line.substr(0, line.size() - 1)).append(" ");
        if (!lines.next()) refuse("the file ends behind a \"\\\"");
        line = lines.line();
      }
      line = joined.append(line);
    }
    const auto words = split_words(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    const std::size_t number = lines.number();
    const auto corners = [&](std::size_t least) {
      if (words.size() < least + 1) refuse_line(number, "has fewer than " + std::to_string(least) + " vertices");
      std::vector<std::size_t> found;
      for (std::size_t k = 1; k < words.size(); ++k) found.push_back(obj_vertex(words[k], counts, number));
      return found;
    };
    if (words[0] == "v") {
      obj_numbers(words, 3, 7, number);  // with a weight or a colour
      points.push_back(point_of(words, 1, number));
      counts[0] = points.size();
    } else if (words[0] == "vt") {
      obj_numbers(words, 1, 3, number);
      ++counts[1];
    } else if (words[0] == "vn") {
      obj_numbers(words, 3, 3, number);
      ++counts[2];
    } else if (words[0] == "f") {
      add_polygon(mesh, points, corners(3));
    } else if (words[0] == "l") {
      const auto line_of = corners(2);
      for (std::size_t k = 0; k + 1 < line_of.size(); ++k)
        add_segment(mesh, points[line_of[k]], points[line_of[k + 1]]);
    } else if (std::find(std::begin(passed), std::end(passed), words[0]) == std::end(passed)) {
      refuse_line(number, "begins with " + in_quotes(words[0]) + ", which is not read");
    }
  }
}

// --- .csv ------------------------------------------------------------------------------------------------------------

/// The units of a heading of two names, x and y; nothing: the line is none. Throws Refused for a unit that is no
/// length.
std::optional<std::array<UnitSize, 2>> units_of_heading(const std::vector<std::string>& fields, std::size_t line,
                                                        std::string& unit) {
  if (fields.size() != 2) return std::nullopt;
  std::array<UnitSize, 2> units;
  for (std::size_t d = 0; d < 2; ++d) {
    const ColumnHead head = head_of(fields[d], Quantity::length);
    if (!is_name(head.name)) return std::nullopt;
    if (!head.unit) continue;
    const auto found = unit_of(*head.unit, Quantity::length);
    if (!found)
      refuse_line(line, "has the column " + head.name + " in " + in_quotes(*head.unit) + "; expected a unit of " +
                            units_text(Quantity::length));
    units[d] = *found;
    if (found->times != found->over) unit = *head.unit;
  }
  return units;
}

void corners_of_polygons(std::string_view text, Mesh& mesh) {
  std::vector<Vec3> corners;
  std::size_t last = 0;  // line of a corner
  const auto close = [&] {
    if (!corners.empty() && corners.size() < 3)
      refuse_line(last, "ends a polygon of " + std::to_string(corners.size()) +
                            (corners.size() == 1 ? " corner" : " corners") + "; expected 3 or more");
    for (std::size_t i = 0; i < corners.size(); ++i) add_segment(mesh, corners[i], corners[(i + 1) % corners.size()]);
    corners.clear();
  };
  std::array<UnitSize, 2> units;
  Lines lines(text);
  bool first = true;
  while (lines.next()) {
    const std::string_view line = lines.line();
    const std::size_t begin = line.find_first_not_of(blanks);
    if (begin == std::string_view::npos) {
      close();
      continue;
    }
    const bool comment = line[begin] == '#';
    const auto fields = fields_of(comment ? line.substr(begin + 1) : line, true);
    if (comment) {  // a heading of names with units may stand in one, as numpy.savetxt writes it
      const bool units_there = first && fields && line.find_first_of("[(") != std::string_view::npos;
      if (const auto heading = units_there ? units_of_heading(*fields, lines.number(), mesh.unit) : std::nullopt)
        units = *heading;
      continue;
    }
    if (!fields) refuse_line(lines.number(), "has a field whose quote is not closed");
    const auto heading = first ? units_of_heading(*fields, lines.number(), mesh.unit) : std::nullopt;
    first = false;
    if (heading) {
      units = *heading;
      continue;
    }
    Vec3 corner{};
    if (fields->size() != 2) refuse_line(lines.number(), "is not a corner x, y");
    for (std::size_t d = 0; d < 2; ++d) {
      const std::string& field = (*fields)[d];
      const auto value = coordinate_of(field);
      if (!value && field.find(',') != std::string::npos) refuse_line(lines.number(), "has " + no_number(field));
      if (!value) refuse_line(lines.number(), "is not a corner x, y");
      corner[d] = units[d].of(*value);
    }
    corners.push_back(corner);
    last = lines.number();
  }
  close();
}

/// The text behind a byte-order mark. Throws Refused for what is no text that we read.
std::string_view plain_text(std::string_view bytes) {
  if (const std::string why = why_no_text(bytes); !why.empty()) refuse(why);
  return without_mark(bytes);
}

}  // namespace

Mesh parse_stl(std::string_view bytes) {
  return whole([&](Mesh& mesh) {
    // Programs begin the head of the binary form with "solid" too: its size tells the two apart.
    const bool fits =
        bytes.size() >= 84 && bytes.size() == 84 + 50 * std::size_t{bytes_as<std::uint32_t>(bytes.data() + 80, false)};
    if (fits) return stl_binary(bytes, mesh);
    const std::string_view text = plain_text(bytes);
    const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    if (same(text.substr(begin, 5), "solid") && text.find('\0') == std::string_view::npos) stl_text(text, mesh);
    else stl_binary(bytes, mesh);
  });
}

Mesh parse_obj(std::string_view text) {
  return whole([&](Mesh& mesh) { obj(plain_text(text), mesh); });
}

Mesh parse_corners(std::string_view text) {
  return whole([&](Mesh& mesh) { corners_of_polygons(plain_text(text), mesh); });
}

}  // namespace barchan
