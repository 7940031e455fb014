// Height of the ground as a function of place, prepared once and asked often. Internal to src/start.
#pragma once

#include <memory>

#include "scene/formula.hpp"
#include "scene/scene.hpp"

namespace barchan {

class Ground {
 public:
  explicit Ground(const Scene& scene);  ///< of the first fill that is a bed; none: height 0
  Ground(const BedShape& bed, const Domain& domain);
  bool exists() const { return exists_; }
  double height(double x, double z) const;    ///< m over the bottom of the domain; z: along the third axis
  double flat() const { return bed_.depth; }  ///< the same where there is no dune

 private:
  double profile(double s) const;
  bool exists_ = false;
  BedShape bed_;
  double period_ = 0.0;  // m; 0: the profile does not repeat itself
  std::shared_ptr<const Formula> formula_;
};

}  // namespace barchan
