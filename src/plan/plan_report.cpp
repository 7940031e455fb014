// The plan as a person reads it, and as JSON.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "models/grains/grain_source.hpp"
#include "plan/formatted.hpp"
#include "plan/run_cost.hpp"

namespace barchan {

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string all;
  for (const auto& w : words) all += (all.empty() ? "" : ", ") + w;
  return all.empty() ? "none" : all;
}

/// In steps of the planned length (s).
std::string calls_of(const RepeatCount& r, double step) {
  const double each = step / r.interval;
  if (each > 1.0 + 1e-9) return formatted("%.0f in a step", std::ceil(each * (1.0 - 1e-9)));
  const double steps = std::ceil(1.0 / each * (1.0 - 1e-9));
  return steps > 1.0 ? formatted("one in %.0f steps", steps) : "one in a step";
}

/// The name of its kernel; "none" where a scene can give no kernel.
std::string kernel_of(const PlanEntry& e) {
  if (e.own_steps()) return "none";
  for (const Word& w : words_of<KernelKind>)
    if (w.meaning == static_cast<int>(e.kernel)) return std::string(w.word);
  return "";
}

}  // namespace

std::string to_text(const Plan& plan, const Scene& scene) {
  std::string t = scene.title.empty() ? scene.name + "\n" : scene.title + "\n";
  t += formatted("%dD, dx = %g m, %.0f particles, %g s\n\n", plan.dimensions, scene.spacing, plan.particles(),
                 scene.time.end);
  t += formatted("%-12s %-8s %10s %10s %12s %10s  %s\n", "phase", "kind", "particles", "dx [m]", "mass [kg]", "c [m/s]",
                 "fields");
  for (const auto& p : plan.phases) {
    std::vector<std::string> names;
    for (const Field f : p.fields) names.emplace_back(info(f).name);
    t += formatted("%-12s %-8s %10zu %10.4g %12.4g %10.4g  ", p.name.c_str(), p.kind.c_str(), p.count, p.spacing,
                   p.mass, p.sound_speed);
    t += joined(names) + "\n";
  }
  t += formatted("\n%-16s %-10s %-13s %6s %11s %8s %8s  %s\n", "entry", "law", "kernel", "r/dx", "neighbours", "sum VW",
                 "gradient", "(on a lattice; the truth is 1 and 1)");
  for (const auto& e : plan.entries)
    t += formatted("%-16s %-10s %-13s %6.3g %11d %8.4f %8.4f  %s\n", e.name.c_str(), e.law.c_str(),
                   e.own_steps() ? "-" : kernel_of(e).c_str(), e.radius / e.spacing, e.consistency.neighbours,
                   e.consistency.volume_sum, e.consistency.gradient_sum, e.meaning.c_str());
  t += "\n";
  for (const auto& p : plan.phases)
    if (!p.enclosure.empty())
      t += formatted("%s is %senclosed: %s\n", p.name.c_str(), p.enclosed ? "" : "not ", p.enclosure.c_str());
  t += "passes  " + joined(plan.passes) + "\nskipped " + joined(plan.skipped) + "\n";
  for (const auto& r : plan.repeats)
    t += formatted("repeats %s of %s: one in %.4g s, %s\n", r.name.c_str(), r.owner.c_str(), r.interval,
                   calls_of(r, plan.step()).c_str());
  for (const auto& i : plan.instruments)
    t += "measured " + to_text(i) + (i.start > scene.time.end ? ": after the end, nothing is averaged\n" : "\n");
  for (std::size_t k = 0; k < scene.influxes.size(); ++k) {
    const Influx& influx = scene.influxes[k];
    const double time = std::min(influx.end.value_or(scene.time.end), scene.time.end) - influx.start;
    t += formatted("enters  %s: about %.3g grains in the run; its time, below, is that of what is there at the start\n",
                   influx.phase.c_str(), std::max(0.0, time / Arrivals(scene, k, plan.slab).mean_wait()));
  }
  t += "not measured " + joined(not_measured(plan.instruments)) + "\n\n";
  if (plan.fixed_step > 0) t += formatted("step    %.4g s, fixed by the scene\n", plan.fixed_step);
  for (const auto& l : plan.limits)
    t += formatted("%-7s %.4g s  %-18s %s%s\n", &l == plan.limits.data() && plan.fixed_step <= 0 ? "step" : "", l.value,
                   l.name.c_str(), l.reason.c_str(), l.value <= plan.step() * (1 + 1e-12) ? "   <- rules" : "");
  for (const auto& w : plan.warnings) t += "warning: " + w + "\n";
  return t + "\n";
}

std::string to_text(const Estimate& e) {
  if (!e.measured) return "not measured: " + e.failure + "\n";
  std::string t = e.failure.empty() ? "pairs  " : "measured as far as it goes: " + e.failure + "\npairs  ";
  for (const auto& [name, count] : e.pairs)
    t += formatted(" %s %llu ", name.c_str(), static_cast<unsigned long long>(count));
  t += "\n" + to_text(e.memory);
  t += formatted(
      "run     about %.0f steps, %.3g s of processor time at %.2f M particle-steps/s (medians of the first steps)",
      e.steps, e.processor_seconds, e.particle_steps_per_second * 1e-6);
  t += e.threads == 1 ? "\n" : formatted(": %.3g s if %d threads share it evenly\n", e.seconds, e.threads);
  if (e.start_seconds > 1.0)
    t += formatted("start   %.3g s to make the particles, beds that settle included\n", e.start_seconds);
  if (e.ranks) t += to_text(*e.ranks);
  const double all = e.seconds + e.start_seconds, hour = 3600.0;
  if (all > hour) t += formatted("warning: the run takes about %.1f hours\n", all / hour);
  return t;
}

std::string to_json(const Plan& plan, const Scene& scene, const Estimate& estimate) {
  nlohmann::ordered_json j;
  j["title"] = scene.title;
  j["dimensions"] = plan.dimensions;
  j["spacing"] = scene.spacing;
  j["end"] = scene.time.end;
  for (const auto& p : plan.phases) {
    nlohmann::ordered_json q;
    q["kind"] = p.kind;
    q["particles"] = p.count;
    q["spacing"] = p.spacing;
    q["mass"] = p.mass;
    q["sound_speed"] = p.sound_speed;
    q["smoothing_length"] = p.smoothing_length;
    if (!p.enclosure.empty()) {
      q["enclosed"] = p.enclosed;
      q["enclosure"] = p.enclosure;
    }
    q["fields"] = nlohmann::ordered_json::array();
    for (const Field f : p.fields) q["fields"].push_back(info(f).name);
    j["phases"][p.name] = q;
  }
  for (const auto& e : plan.entries) {
    nlohmann::ordered_json q;
    q["law"] = e.law;
    q["kernel"] = kernel_of(e);
    q["radius"] = e.radius;
    q["neighbours"] = e.consistency.neighbours;
    q["volume_sum"] = e.consistency.volume_sum;
    q["gradient_sum"] = e.consistency.gradient_sum;
    q["consistent"] = e.consistency.consistent();
    q["corrected"] = e.corrected;
    q["meaning"] = e.meaning;
    j["interactions"][e.name] = q;
  }
  for (const auto& [name, count] : estimate.pairs) j["interactions"][name]["pairs"] = count;
  j["passes"] = plan.passes;
  j["skipped"] = plan.skipped;
  j["repeats"] = nlohmann::ordered_json::array();
  for (const auto& r : plan.repeats)
    j["repeats"].push_back({{"name", r.name}, {"of", r.owner}, {"interval", r.interval}});
  j["measured"] = nlohmann::ordered_json::array();
  for (const auto& i : plan.instruments)
    j["measured"].push_back({{"kind", kind_name(i.kind)},
                             {"name", i.name},
                             {"phase", i.phase_name},
                             {"rows", i.rows.size()},
                             {"every", i.every},
                             {"start", i.start},
                             {"files", i.files()}});
  j["not_measured"] = not_measured(plan.instruments);
  j["warnings"] = plan.warnings;
  j["step"] = plan.step();
  for (const auto& l : plan.limits) j["limits"][l.name] = {{"value", l.value}, {"reason", l.reason}};
  j["memory"]["bytes"] = estimate.memory.bytes();
  j["memory"]["measured"] = estimate.memory.measured;
  for (const auto& [name, bytes] : estimate.memory.parts) j["memory"]["parts"][name] = bytes;
  if (!estimate.failure.empty()) j["failure"] = estimate.failure;
  j["estimate"] = {{"steps", estimate.steps},
                   {"threads", estimate.threads},
                   {"seconds", estimate.seconds},
                   {"start_seconds", estimate.start_seconds},
                   {"processor_seconds", estimate.processor_seconds},
                   {"particle_steps_per_second", estimate.particle_steps_per_second},
                   {"bytes", estimate.bytes}};
  j["history"] = estimate.history;
  if (estimate.ranks) j["ranks"] = nlohmann::ordered_json::parse(to_json(*estimate.ranks));
  return j.dump(2) + "\n";
}

}  // namespace barchan
