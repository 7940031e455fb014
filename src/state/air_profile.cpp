#include "state/air_profile.hpp"

namespace barchan {

void AirProfile::archive(Archive& a) {
  a.array("air: faces", face);
  a.array("air: speed", speed);
  a.array("air: stress", stress);
  a.array("air: mixing length", length);
  a.array("air: given", given);
  a.array("air: mean rate", mean_rate);
  a.array("air: mean push", mean_push);
  a.number("air: boundary", boundary);
  a.number("air: elapsed", elapsed);
  a.number("air: kicked", kicked);
  a.number("air: last", last);
  a.number("air: step", step);
}

}  // namespace barchan
