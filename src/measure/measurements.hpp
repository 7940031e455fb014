// Takes samples of the state when they are due and writes what they average to. It only reads the state.
#pragma once

#include <filesystem>
#include <vector>

#include "measure/averages.hpp"
#include "measure/fit.hpp"
#include "measure/instrument.hpp"
#include "measure/table.hpp"
#include "output/history.hpp"
#include "state/state.hpp"

namespace barchan {

class Measurements {
 public:
  /// `densities`: of all phases at rest, kg/m3.
  Measurements(std::vector<Instrument> instruments, const Bounds& bounds, std::vector<double> densities);

  /// Makes the probes' files in the folder, which is there; or continues those that are there, whose rows later than
  /// `until` (s) are dropped. Throws OutputError.
  void open(const std::filesystem::path& directory, bool append = false, double until = 0.0);

  /// Brings the probes' rows to the disk. Throws OutputError.
  void sync() const {
    for (const History& probe : probes_) probe.sync();
  }
  /// Files of probes that somebody removed while they were written.
  std::vector<std::string> removed() const {
    std::vector<std::string> files;
    for (const History& probe : probes_)
      if (std::string file = probe.removed(); !file.empty()) files.push_back(std::move(file));
    return files;
  }

  /// Takes the samples that are due at the state's time: the first step at or after start + k every. Never changes
  /// the length of a step. With open() the probes' rows are written. The same bits on any number of threads.
  void sample(const State& state);

  /// Replaces the files of averages, each whole or not at all. Throws OutputError.
  void write(const std::filesystem::path& directory, double time);

  /// Means and fluctuations of an instrument so far, one row a place; nan where nothing was sampled.
  Table table(std::size_t instrument);

  /// Everything that has been sampled so far.
  void archive(Archive& a);

  const std::vector<Instrument>& instruments() const { return instruments_; }
  const Accumulators& accumulators() const { return memory_; }
  double seconds() const { return seconds_; }  ///< s of wall time spent in sample() and write()

 private:
  struct Place {  // of an instrument's first row in the accumulators
    std::size_t row = 0, flux = 0, mean = 0, comoment = 0;
  };
  using Sample = std::array<double, 5>;

  Average average(std::size_t instrument, std::size_t row);
  bool due(std::size_t instrument, double time);
  Lookup& lookup(std::size_t instrument, const State& state);
  void gather(const State& state);
  /// The particles of a phase: on several ranks those of all of them that the instruments at hand look at.
  const PhaseParticles& seen(const State& state, std::size_t phase) const {
    return gathered_.empty() ? state.phases[phase] : gathered_[phase];
  }
  void read_points(std::size_t instrument, const State& state);
  void take_points(std::size_t instrument);
  void take_slices(std::size_t instrument, const State& state);
  void take_layers(std::size_t instrument, const State& state);
  void take_ground(std::size_t instrument, const State& state);
  Table layers(std::size_t instrument);
  Table ground(std::size_t instrument);
  void add_flux(std::size_t instrument, Table& table) const;
  double bed_of(std::size_t instrument);
  void write_decay(std::size_t instrument, const std::filesystem::path& file, double time);
  void write_probe(std::size_t instrument, double time);

  std::vector<Instrument> instruments_;
  Bounds bounds_;
  std::vector<double> densities_;
  std::vector<Place> places_;
  Accumulators memory_;

  struct Searched {
    std::size_t phase;
    double radius;
    Lookup lookup;
    long step;  // for which it was made
  };
  std::vector<std::size_t> due_;          // the instruments at hand
  std::vector<PhaseParticles> gathered_;  // by phase, on several ranks
  std::vector<Searched> lookups_;         // one a phase and radius
  std::vector<double> sums_;              // of the saltation at hand, by slice
  std::vector<Reading> readings_;         // of the instrument at hand, by point; then by row
  std::vector<History> probes_;
  double seconds_ = 0;
};

}  // namespace barchan
