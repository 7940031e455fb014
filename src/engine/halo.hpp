// The one halo: the images of records, made by the engine from what the tasks of the schedule say that they write and
// read.
#pragma once

#include <cstddef>

#include "state/access.hpp"

namespace barchan {

/// Who holds the records of all phases. An image is a copy of a record of this process' own particles, moved by periods
/// of the domain; it knows its source (CellGrid::image_list). Phases are numbers of the layout.
class Halo {
 public:
  Halo() = default;
  virtual ~Halo() = default;
  Halo(const Halo&) = delete;
  Halo& operator=(const Halo&) = delete;

  /// Makes the images of a phase's records from the records as they are now. Does nothing when they are of now.
  virtual void fill_images(std::size_t phase, Record record) = 0;
  /// The records have new values: their images are of an earlier moment.
  virtual void outdate_images(std::size_t phase, Record record) = 0;
};

}  // namespace barchan
