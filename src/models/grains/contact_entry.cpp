#include "models/grains/contact_entry.hpp"

#include <algorithm>
#include <cmath>

#include "base/errors.hpp"
#include "kernels/kernel.hpp"
#include "models/pair_forces.hpp"

namespace barchan {

namespace {

/// Kernel contact for an entry: stiffness of the softer of the phases that move, damping from the restitution.
KernelContact contact_law(const Scene& scene, const Layout& layout, const PlanEntry& e) {
  const PlanPhase &a = layout.phases[e.a], &b = layout.phases[e.b];
  const auto stiffness_of = [](const PlanPhase& p) { return p.mass * std::pow(p.sound_speed, 2); };
  const PlanPhase& soft = !b.yields() || (a.yields() && stiffness_of(a) <= stiffness_of(b)) ? a : b;
  const double d = 0.5 * (a.spacing + b.spacing);  // m, of two that touch
  const double reduced =
      a.yields() && b.yields() ? a.mass * b.mass / (a.mass + b.mass) : (a.yields() ? a.mass : b.mass);
  double restitution = 1.0;
  for (const std::size_t k : {e.a, e.b})
    if (layout.phases[k].separate()) restitution = std::min(restitution, scene.phases[k].grains().restitution);
  KernelContact law{};
  with_kernel<double>(e.kernel, e.radius, layout.dimensions, [&](const auto& kernel) {
    law.rest_value = kernel.value(d);
    const double slope = std::abs(kernel.derivative(d));
    if (slope <= 0)
      throw SceneError("interactions." + e.name +
                       ": a contact needs a radius beyond one spacing (1.1 in eq. 16 of "
                       "Halik et al. 2015), so that grains that touch interact");
    law.inverse_slope = 1.0 / slope;
  });
  law.stiffness = 1.0 * soft.mass / (d * d) * soft.sound_speed * soft.sound_speed;
  const double zeta = KernelContact::damping_ratio(restitution);
  law.damping = 2.0 * zeta * std::sqrt(law.stiffness * reduced);
  return law;
}

}  // namespace

void describe_kernel_contact(const Scene& scene, const Interaction& pair, const Layout& layout, PlanEntry& e) {
  e.law = "contact";
  e.keeps_apart = e.gives_length = true;
  describe_kernel_sums(pair, scene.dimensions, e);
  // The largest energy that the contact can store, 1/2 K g(0)^2 with K = m c^2/d^2 (laws/kernel_contact.hpp).
  with_kernel<double>(e.kernel, e.radius, scene.dimensions, [&](const auto& kernel) {
    const double d = 0.5 * (layout.phases[e.a].spacing + layout.phases[e.b].spacing);
    e.stopping_depth = (kernel.value(0.0) - kernel.value(d)) / std::abs(kernel.derivative(d));
  });
}

std::unique_ptr<Model> make_contact_entry(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  const KernelContacts law{{}, contact_law(scene, layout, entry)};
  return std::make_unique<ForceEntry<KernelContacts>>(layout, entry, law, stage::contacts,
                                                      FieldSet{Field::position, Field::velocity});
}

void describe_ghosts(const Scene& scene, const Interaction& pair, const Layout&, PlanEntry& e) {
  e.law = "repulsive";
  describe_kernel_sums(pair, scene.dimensions, e);
}

std::unique_ptr<Model> make_ghosts(const Scene& scene, const Layout& layout, const PlanEntry& entry) {
  KernelContacts law{{}, contact_law(scene, layout, entry)};
  // Ghosts push a fluid without damping, K = m c u / d^2 with u = c/10: the largest speed where the sound speed is
  // automatic.
  const PlanPhase& p = layout.phases[entry.fluid];
  law.contact.stiffness = p.mass / (p.spacing * p.spacing) * p.sound_speed * 0.1 * p.sound_speed;
  law.contact.damping = 0.0;
  return std::make_unique<ForceEntry<KernelContacts>>(layout, entry, law, stage::repel,
                                                      FieldSet{Field::position, Field::velocity});
}

}  // namespace barchan
