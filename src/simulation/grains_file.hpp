// Fills with shape = { file = ... }: spheres where a frame of an earlier run has them.
#pragma once

#include "output/frame.hpp"
#include "start/generate.hpp"

namespace barchan {

/// The places and radii of the fill's phase in its file, in the order of the file. Throws SceneError with the line of
/// the key when the file cannot be read, has no such phase, no radii though they differ, or a grain that the phase
/// cannot have.
SettledGrains grains_of_file(const Scene& scene, std::size_t fill);

/// Adds to Frame::contacts those of particles whose first has the id `first_id`.
void add_contacts(Frame& frame, const std::vector<RestingContact>& contacts, std::int64_t first_id);

}  // namespace barchan
