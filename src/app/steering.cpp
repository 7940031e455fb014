#include "app/steering.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numeric>
#include <vector>

#include "base/fields.hpp"
#include "scene/controls.hpp"

namespace barchan {

namespace {

constexpr std::size_t longest_request = 65536;  // bytes

nlohmann::ordered_json state_of(const Simulation& simulation, bool ended) {
  nlohmann::ordered_json j{{"time", simulation.time()}, {"steps", simulation.steps()}, {"ended", ended}};
  for (const PhaseParticles& p : simulation.phases()) {
    nlohmann::ordered_json& phase = j["phases"][p.name()];
    phase["particles"] = p.size();
    phase["fields"] = nlohmann::ordered_json::array({"id"});
    for (std::size_t f = 0; f < field_count; ++f)
      if (p.has(static_cast<Field>(f))) phase["fields"].push_back(info(static_cast<Field>(f)).name);
  }
  j["controls"] = nlohmann::ordered_json::object();
  for (const Control& control : controls()) j["controls"][control.name] = control.value;
  return j;
}

/// The values of a field, or the ids, in the order of ids; the heading of the answer before them.
std::string array_of(const PhaseParticles& p, const std::string& name) {
  std::vector<std::uint32_t> order(p.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return p.id()[a] < p.id()[b]; });
  const auto field = find_field(name);
  const std::size_t width = field ? static_cast<std::size_t>(p.components(*field)) : 1;
  std::string bytes(order.size() * width * 8, '\0');
  char* to = bytes.data();
  for (const std::uint32_t k : order)
    for (std::size_t d = 0; d < width; ++d, to += 8) {
      if (field) std::memcpy(to, p.column(*field, static_cast<int>(d)) + k, 8);
      else std::memcpy(to, &p.id()[k], 8);
    }
  const nlohmann::ordered_json heading{
      {"rows", order.size()}, {"columns", width}, {"type", field ? "f8" : "i8"}, {"bytes", bytes.size()}};
  return heading.dump() + "\n" + bytes;
}

std::string fault(const std::string& what) { return nlohmann::ordered_json{{"error", what}}.dump() + "\n"; }

}  // namespace

bool Steering::read_line(std::string& line) {
  for (;;) {
    if (const std::size_t end = come_.find('\n'); end != std::string::npos) {
      line = come_.substr(0, end);
      come_.erase(0, end + 1);
      return true;
    }
    char bytes[4096];
    const ssize_t n = come_.size() > longest_request ? 0 : ::read(requests_, bytes, sizeof bytes);
    if (n <= 0) return false;  // the other program has ended, or a signal came: the run ends
    come_.append(bytes, static_cast<std::size_t>(n));
  }
}

void Steering::write(const std::string& bytes) const {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(answers_, bytes.data() + at, bytes.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return;  // the next read fails too
    at += static_cast<std::size_t>(n);
  }
}

Steering::Asked Steering::carry_out(const std::string& request, const Simulation& simulation, bool ended) {
  const nlohmann::ordered_json j = nlohmann::ordered_json::parse(request, nullptr, false);
  const std::string what = j.is_object() ? j.value("do", "") : "";
  if (what == "stop") return Asked::stop;
  if (what == "steps" || what == "until") {
    if (ended) {
      write(fault("the run has ended; expected a scene with a later time.end"));
      return Asked::more;
    }
    until_step_ = what == "steps" ? simulation.steps() + j.value("count", 1L) : 0;
    until_time_ = what == "until" ? j.value("time", 0.0) : 0.0;
    waits_ = true;
    return Asked::go;
  }
  if (what == "state") {
    write(state_of(simulation, ended).dump() + "\n");
  } else if (what == "history") {
    const HistoryRow row = simulation.history();
    write(nlohmann::ordered_json{{"names", row.names}, {"values", row.values}}.dump() + "\n");
  } else if (what == "array") {
    const std::string phase = j.value("phase", ""), field = j.value("field", "");
    const auto& all = simulation.phases();
    const auto p = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name() == phase; });
    if (p == all.end()) write(fault("no phase \"" + phase + "\""));
    else if (const auto f = find_field(field); field != "id" && !(f && p->has(*f)))
      write(fault("the phase \"" + phase + "\" has no field \"" + field + "\""));
    else write(array_of(*p, field));
  } else if (what == "control") {
    const std::string name = j.value("name", "");
    const auto value = j.find("value");
    double* const control = find_control(name);
    if (!control) write(fault("no control \"" + name + "\"; expected a name of [controls]"));
    else if (value == j.end() || !value->is_number()) write(fault("a control has a finite number"));
    else {
      *control = value->get<double>();
      write("{}\n");
    }
  } else {
    write(fault("not a request: " + request.substr(0, 200)));
  }
  return Asked::more;
}

bool Steering::goes_on(const Simulation& simulation, bool ended) {
  if (!ended && (simulation.steps() < until_step_ || simulation.time() < until_time_ * (1.0 - 1e-12))) return true;
  until_step_ = 0;
  until_time_ = 0.0;
  if (waits_)
    write(nlohmann::ordered_json{{"time", simulation.time()}, {"steps", simulation.steps()}, {"ended", ended}}.dump() +
          "\n");
  waits_ = false;
  for (std::string request; read_line(request);) {
    const Asked asked = carry_out(request, simulation, ended);
    if (asked == Asked::go) return true;
    if (asked == Asked::stop) return false;
  }
  return false;
}

}  // namespace barchan
