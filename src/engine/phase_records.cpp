#include "engine/phase_records.hpp"

#include <stdexcept>

namespace barchan {

namespace {

int size_of(Record record, int dimensions) {
  const bool flat = dimensions == 2;
  switch (record) {
    case Record::motion:
    case Record::extended:
    case Record::turbulence: return flat ? MotionRecord<2>::size : MotionRecord<3>::size;
    case Record::stress: return flat ? StressRecord<2>::size : StressRecord<3>::size;
    case Record::artificial: return ArtificialStressRecord::size;
    case Record::carried: return flat ? CarriedRecord<2>::size : CarriedRecord<3>::size;
    case Record::surface: return flat ? SurfaceRecord<2>::size : SurfaceRecord<3>::size;
    case Record::compact:
    case Record::eddies: break;
  }
  return 0;
}

template <std::size_t Dim>
std::array<const double*, Dim> positions(const PhaseParticles& p) {
  std::array<const double*, Dim> x{};
  for (std::size_t d = 0; d < Dim; ++d) x[d] = p.column(Field::position, static_cast<int>(d));
  return x;
}

}  // namespace

PhaseRecords::PhaseRecords(const std::string& phase, int dimensions) : phase_(phase), dimensions_(dimensions) {
  eddies_.label = {phase, Record::eddies};
}

RecordLabel& PhaseRecords::label(Record record) {
  if (record == Record::eddies) return eddies_.label;
  return record == Record::compact && compact_ ? compact_->label : array(record).label;
}

void PhaseRecords::make(Record record) {
  if (record == Record::compact) throw std::logic_error("compact records need the bounds of the domain");
  if (record == Record::eddies) has_eddies_ = true;
  else if (RecordArray& a = array(record); a.stride() == 0) a = RecordArray(size_of(record, dimensions_));
  label(record) = {phase_, record};
}

void PhaseRecords::make_compact(const Bounds& bounds) {
  compact_ = std::make_unique<CompactRecords>(bounds);
  compact_->label = {phase_, Record::compact};
}

bool PhaseRecords::has(Record record) const {
  if (record == Record::compact) return compact_ != nullptr;
  return record == Record::eddies ? has_eddies_ : array(record).stride() > 0;
}

void PhaseRecords::fit(std::size_t particles, std::size_t images) {
  for (RecordArray& a : arrays_)
    if (a.stride() > 0) a.resize(particles, images);
  if (compact_) compact_->resize(particles, images);
  if (has_eddies_) eddies_.resize(particles, images);
  for (std::size_t r = 0; r < record_count; ++r) outdate_images(static_cast<Record>(r));
}

void PhaseRecords::fill_images(Record record, const PhaseParticles& particles, const CellGrid& grid) {
  if (label(record).images_of_now || !has(record)) return;
  switch (record) {
    case Record::compact:
      dimensions_ == 2 ? compact_->fill_images<2>(grid, positions<2>(particles))
                       : compact_->fill_images<3>(grid, positions<3>(particles));
      break;
    case Record::eddies: eddies_.fill_images(particles.size(), grid); break;
    case Record::artificial: array(record).fill_images(grid, 0); break;  // they hold no position
    default: array(record).fill_images(grid, dimensions_);
  }
  label(record).images_of_now = true;
}

std::size_t PhaseRecords::bytes_of_an_image(Record record) const {
  if (!has(record)) return 0;
  if (record == Record::compact) return CompactRecords::size * sizeof(float);
  return record == Record::eddies ? EddyRecords::of_a_particle : array(record).stride() * sizeof(double);
}

std::size_t PhaseRecords::bytes_of_an_image() const {
  std::size_t total = 0;
  for (std::size_t r = 0; r < record_count; ++r) total += bytes_of_an_image(static_cast<Record>(r));
  return total;
}

std::size_t PhaseRecords::bytes() const {
  std::size_t total = compact_ ? compact_->bytes() : 0;
  for (const RecordArray& a : arrays_) total += a.bytes();
  return total + eddies_.bytes();
}

}  // namespace barchan
