#include "output/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>

#include "base/errors.hpp"
#include "output/numbers.hpp"
#include "output/series.hpp"

namespace barchan {
namespace {

/// One particle in both frames.
struct Match {
  std::int64_t id;
  std::size_t a, b;
};

/// Particle numbers in the order of their ids, so that the first difference found is that of the lowest id.
std::vector<std::size_t> by_id(const Frame& frame) {
  std::vector<std::size_t> order(frame.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto j) { return frame.id[i] < frame.id[j]; });
  return order;
}

struct Matching {
  std::vector<Match> both;
  std::vector<std::int64_t> only_a, only_b, twice;
};

Matching match(const Frame& a, const Frame& b) {
  const auto order_a = by_id(a), order_b = by_id(b);
  Matching found;
  std::size_t i = 0, j = 0;
  while (i < order_a.size() || j < order_b.size()) {
    constexpr auto none = std::numeric_limits<std::int64_t>::max();
    const std::int64_t id_a = i < order_a.size() ? a.id[order_a[i]] : none;
    const std::int64_t id_b = j < order_b.size() ? b.id[order_b[j]] : none;
    const std::int64_t id = std::min(id_a, id_b);
    const std::size_t first_a = i, first_b = j;
    while (i < order_a.size() && a.id[order_a[i]] == id) ++i;
    while (j < order_b.size() && b.id[order_b[j]] == id) ++j;
    if (i - first_a > 1 || j - first_b > 1) found.twice.push_back(id);
    if (i == first_a) found.only_b.push_back(id);
    else if (j == first_b) found.only_a.push_back(id);
    else found.both.push_back({id, order_a[first_a], order_b[first_b]});
  }
  return found;
}

/// |a - b|; equal infinities and two NaN do not differ, a NaN against a number differs without bound.
double distance(double a, double b) {
  if (a == b || (std::isnan(a) && std::isnan(b))) return 0.0;
  const double d = std::abs(a - b);
  return std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

FieldDifference difference(const std::string& name, std::span<const double> a, std::span<const double> b,
                           std::size_t components, const std::vector<Match>& matches, double tolerance) {
  FieldDifference d;
  d.field = name;
  for (const double value : a)
    if (std::isfinite(value)) d.scale = std::max(d.scale, std::abs(value));
  const double unit = d.scale > 0 ? d.scale : 1.0;

  double sum = 0, squares = 0;
  for (const auto& m : matches) {
    double most = 0, most_a = 0, most_b = 0;
    for (std::size_t c = 0; c < components; ++c) {
      const double value_a = a[m.a * components + c], value_b = b[m.b * components + c];
      const double apart = distance(value_a, value_b);
      const double relative = apart > 0 ? std::max(apart / unit, std::numeric_limits<double>::denorm_min()) : 0.0;
      sum += relative;
      squares += relative * relative;
      if (relative > most) most = relative, most_a = value_a, most_b = value_b;
    }
    d.largest = std::max(d.largest, most);
    if (d.first_id < 0 && most > tolerance) d.first_id = m.id, d.first_a = most_a, d.first_b = most_b;
  }
  if (const auto n = static_cast<double>(matches.size() * components); n > 0) {
    d.l1 = sum / n;
    d.l2 = std::sqrt(squares / n);
  }
  return d;
}

std::vector<double> as_numbers(const std::vector<std::int32_t>& values) { return {values.begin(), values.end()}; }

const FrameField* find(const Frame& frame, const std::string& name) {
  const auto found = std::find_if(frame.fields.begin(), frame.fields.end(), [&](auto& f) { return f.name == name; });
  return found == frame.fields.end() ? nullptr : &*found;
}

void remark_ids(std::vector<std::string>& remarks, const std::vector<std::int64_t>& ids, const std::string& where) {
  if (ids.empty()) return;
  remarks.push_back(std::to_string(ids.size()) + (ids.size() == 1 ? " particle is " : " particles are ") + where +
                    ", the first has id " + std::to_string(ids.front()));
}

bool above_tolerance(const FieldDifference& d) { return d.first_id >= 0; }

// ---- files ----------------------------------------------------------------------------------------------------------

bool is_series(const std::filesystem::path& file) { return file.extension() == ".pvd"; }

/// A folder stands for the series in it. Throws OutputError where it has none or several.
std::filesystem::path series_of(const std::filesystem::path& file) {
  std::error_code unseen;
  if (!std::filesystem::is_directory(file, unseen)) return file;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(file, unseen))
    if (is_series(entry.path())) found.push_back(entry.path());
  if (found.size() == 1) return found.front();
  throw OutputError("'" + file.string() + "' is a directory with " + std::to_string(found.size()) +
                    " series (.pvd); expected a directory with one, or the series itself");
}

using Entries = std::vector<SeriesWriter::Entry>;

/// Frames of the same time, by their numbers in both lists, which ascend in time.
std::vector<std::pair<std::size_t, std::size_t>> of_one_time(const Entries& a, const Entries& b) {
  constexpr double same = 1e-9;  // of the longer series
  const double longest = std::max(a.empty() ? 0.0 : a.back().time, b.empty() ? 0.0 : b.back().time);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t k = 0, l = 0; k < a.size() && l < b.size();) {
    if (std::abs(a[k].time - b[l].time) <= same * longest) pairs.emplace_back(k++, l++);
    else if (a[k].time < b[l].time) ++k;
    else ++l;
  }
  return pairs;
}

std::vector<FrameDifference> compare_series(const std::filesystem::path& a, const std::filesystem::path& b,
                                            double tolerance) {
  const Entries entries_a = read_pvd(a), entries_b = read_pvd(b);
  const auto pairs = of_one_time(entries_a, entries_b);
  std::vector<FrameDifference> differences;
  for (const auto& [k, l] : pairs) {
    const Frame frame_a = read_frame(a.parent_path() / entries_a[k].file);
    const Frame frame_b = read_frame(b.parent_path() / entries_b[l].file);
    differences.push_back(compare(frame_a, frame_b, tolerance));
    const auto check_entry = [&](const SeriesWriter::Entry& entry, const Frame& frame, const char* which) {
      if (distance(entry.time, frame.time) == 0) return;
      differences.back().same = false;
      differences.back().remarks.push_back("the series " + std::string(which) + " lists the frame at " +
                                           exact(entry.time) + " s, the frame says " + exact(frame.time) + " s");
    };
    check_entry(entries_a[k], frame_a, "A");
    check_entry(entries_b[l], frame_b, "B");
  }
  if (entries_a.size() != pairs.size() || entries_b.size() != pairs.size()) {
    FrameDifference rest;
    rest.same = false;
    rest.remarks.push_back("A has " + std::to_string(entries_a.size()) + " frames, B has " +
                           std::to_string(entries_b.size()) + "; the " + std::to_string(pairs.size()) +
                           " of the same times are compared");
    if (!pairs.empty()) rest.time_a = differences.back().time_a, rest.time_b = differences.back().time_b;
    differences.push_back(rest);
  }
  return differences;
}

std::string table_row(const FieldDifference& d, int width) {
  char line[256];
  std::snprintf(line, sizeof line, "  %-*s  %11.4e  %11.4e  %11.4e  %11.4e\n", width, d.field.c_str(), d.l1, d.l2,
                d.largest, d.scale);
  return line;
}

std::string text_of(const FrameDifference& frame) {
  int width = 5;
  for (const auto& d : frame.fields) width = std::max(width, static_cast<int>(d.field.size()));
  std::string text = "t = " + brief(frame.time_a) + " s";
  if (frame.time_a != frame.time_b) text += " against " + brief(frame.time_b) + " s";
  text += frame.same ? ": same\n" : ": different\n";
  if (!frame.fields.empty()) {
    char line[256];
    std::snprintf(line, sizeof line, "  %-*s  %11s  %11s  %11s  %11s\n", width, "field", "L1", "L2", "largest",
                  "scale");
    text += line;
  }
  for (const auto& d : frame.fields) text += table_row(d, width);
  for (const auto& d : frame.fields)
    if (above_tolerance(d))
      text += "  " + d.field + " differs first at particle " + std::to_string(d.first_id) + ": " + exact(d.first_a) +
              " against " + exact(d.first_b) + "\n";
  for (const auto& remark : frame.remarks) text += "  " + remark + "\n";
  return text;
}

/// The contacts of settled beds, one after another; a difference is told of the number of a contact.
void compare_contacts(const Frame& a, const Frame& b, double tolerance, FrameDifference& result) {
  const auto shape = [](const FrameField& field) {
    return std::tuple(field.name, field.components, field.values.size());
  };
  if (!std::equal(a.contacts.begin(), a.contacts.end(), b.contacts.begin(), b.contacts.end(),
                  [&](const FrameField& x, const FrameField& y) { return shape(x) == shape(y); }))
    return result.remarks.emplace_back("the contacts are others, or more or fewer"), void();
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    const FrameField &x = a.contacts[k], &y = b.contacts[k];
    const auto components = static_cast<std::size_t>(x.components);
    std::vector<Match> matches(components > 0 ? x.values.size() / components : 0);
    for (std::size_t i = 0; i < matches.size(); ++i) matches[i] = {static_cast<std::int64_t>(i), i, i};
    result.fields.push_back(difference(x.name, x.values, y.values, components, matches, tolerance));
  }
}

}  // namespace

FrameDifference compare(const Frame& a, const Frame& b, double tolerance) {
  FrameDifference result;
  result.time_a = a.time;
  result.time_b = b.time;
  auto& remarks = result.remarks;
  const double times = distance(a.time, b.time);
  if (times > 0 && !(std::isfinite(times) && times <= tolerance * std::max(std::abs(a.time), std::abs(b.time))))
    remarks.push_back("the times differ: " + exact(a.time) + " s against " + exact(b.time) + " s");
  if (a.phase_names != b.phase_names) remarks.emplace_back("the phases have different names or another order");

  const Matching found = match(a, b);
  remark_ids(remarks, found.only_a, "only in A");
  remark_ids(remarks, found.only_b, "only in B");
  remark_ids(remarks, found.twice, "there more than once");

  const auto add = [&](const std::string& name, std::span<const double> va, std::span<const double> vb,
                       int components) {
    result.fields.push_back(difference(name, va, vb, static_cast<std::size_t>(components), found.both, tolerance));
  };
  add("position", a.points, b.points, 3);
  add("phase", as_numbers(a.phase), as_numbers(b.phase), 1);
  for (const auto& field : a.fields) {
    const FrameField* other = find(b, field.name);
    if (!other) remarks.push_back("only A has the field '" + field.name + "'");
    else if (other->components != field.components)
      remarks.push_back("the field '" + field.name + "' has " + std::to_string(field.components) +
                        " components in A, " + std::to_string(other->components) + " in B");
    else add(field.name, field.values, other->values, field.components);
  }
  for (const auto& field : b.fields)
    if (!find(a, field.name)) remarks.push_back("only B has the field '" + field.name + "'");

  compare_contacts(a, b, tolerance, result);
  result.same = remarks.empty() && std::none_of(result.fields.begin(), result.fields.end(), above_tolerance);
  return result;
}

std::vector<FrameDifference> compare_files(const std::filesystem::path& a, const std::filesystem::path& b,
                                           double tolerance) {
  const std::filesystem::path one = series_of(a), other = series_of(b);
  if (is_series(one) != is_series(other))
    throw OutputError("cannot compare '" + a.string() + "' with '" + b.string() +
                      "': one is a series, the other a frame");
  if (is_series(one)) return compare_series(one, other, tolerance);
  return {compare(read_frame(one), read_frame(other), tolerance)};
}

std::string to_text(const std::vector<FrameDifference>& differences) {
  std::string text = "L1 (mean), L2 (root mean square) and largest difference, relative to scale, the largest |A|\n";
  for (const auto& frame : differences) text += text_of(frame);
  const auto different = std::count_if(differences.begin(), differences.end(), [](auto& d) { return !d.same; });
  text += different == 0 ? "No difference above the tolerance.\n" : "There are differences.\n";
  return text;
}

std::string to_json(const std::vector<FrameDifference>& differences) {
  using Json = nlohmann::ordered_json;
  Json frames = Json::array();
  bool same = true;
  for (const auto& frame : differences) {
    Json fields = Json::object();
    for (const auto& d : frame.fields) {
      Json field{{"l1", d.l1}, {"l2", d.l2}, {"largest", d.largest}, {"scale", d.scale}};
      if (above_tolerance(d)) field["first"] = {{"id", d.first_id}, {"a", d.first_a}, {"b", d.first_b}};
      fields[d.field] = field;
    }
    frames.push_back({{"same", frame.same},
                      {"time_a", frame.time_a},
                      {"time_b", frame.time_b},
                      {"fields", fields},
                      {"remarks", frame.remarks}});
    same = same && frame.same;
  }
  return Json{{"same", same}, {"frames", frames}}.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace barchan
