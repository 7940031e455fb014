// Which keys `--set` takes: for `barchan list keys` and the completion of shells.
#pragma once

#include <string>
#include <vector>

#include "scene/keys.hpp"

namespace barchan {

struct SettableKey {
  std::string dotted;  // as in --set DOTTED=VALUE
  const Key* key;      // null: of a name that the scene chose (constants)
};

/// The keys of the table, each with the whole way to it. With a scene: phases and pairs have the names of that scene,
/// each phase the keys of its kind, a list as many entries as there are. Without (null): NAME and A-B stand for them.
std::vector<SettableKey> settable_keys(const Scene* scene);

}  // namespace barchan
