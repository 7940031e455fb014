// All records of one phase. Who reads them gets them from here, who writes them says so to the schedule.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "engine/records.hpp"
#include "state/access.hpp"

namespace barchan {

/// The records that the laws of a run read of one phase, each kind with its own length; a kind that nobody reads takes
/// no memory. The addresses of all of them stay the same as long as this object lives.
class PhaseRecords {
 public:
  /// `phase`: its name, for the check of access.
  PhaseRecords(const std::string& phase, int dimensions);

  /// Makes a kind of records (not Record::compact, which has the bounds of the domain as well).
  void make(Record record);
  void make_compact(const Bounds& bounds);
  bool has(Record record) const;

  /// Of motion, extended, stress, artificial, carried, surface; empty if they were not made.
  const RecordArray& array(Record record) const { return arrays_[static_cast<std::size_t>(record)]; }
  RecordArray& array(Record record) { return arrays_[static_cast<std::size_t>(record)]; }
  const CompactRecords* compact() const { return compact_.get(); }
  CompactRecords* compact() { return compact_.get(); }
  const EddyRecords& eddies() const { return eddies_; }
  EddyRecords& eddies() { return eddies_; }

  /// Room for the particles and images of the present lists. Allocates only to grow.
  void fit(std::size_t particles, std::size_t images);
  /// Copies the images from their sources, if the records are newer.
  void fill_images(Record record, const PhaseParticles& particles, const CellGrid& grid);
  void outdate_images(Record record) { label(record).images_of_now = false; }
  std::size_t bytes() const;
  std::size_t bytes_of_an_image() const;  ///< of all kinds
  std::size_t bytes_of_an_image(Record record) const;

 private:
  RecordLabel& label(Record record);

  std::string phase_;
  int dimensions_;
  std::array<RecordArray, record_count> arrays_;  // those of compact and eddies are empty
  std::unique_ptr<CompactRecords> compact_;       // mixed precision: what models/fluid reads
  EddyRecords eddies_;
  bool has_eddies_ = false;
};

}  // namespace barchan
