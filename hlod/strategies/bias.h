// bias.h: how much the screen-space error of a node counts for when part of it is hidden (paper
// 004, the sigmoid bias; the paper states its properties, the formula is our reading).
#pragma once

namespace pagoda::hlod {

// sig_t(mu) = mu^2 / t for mu <= t, else 1 - (1 - mu)^2 / (1 - t); B = (1 - s) mu + s sig_t(mu).
// Monotone, continuous with equal slopes at t, B(0) = 0, B(t) = t, B(1) = 1; never rising in t.
// `mu`, `s` and `t` in [0, 1].
[[nodiscard]] constexpr double sigmoidBias(double mu, double s, double t) {
    const double sigmoid = mu <= t && t > 0.0
                               ? mu * mu / t
                               : 1.0 - (t < 1.0 ? (1.0 - mu) * (1.0 - mu) / (1.0 - t) : 0.0);
    return (1.0 - s) * mu + s * sigmoid;
}

}  // namespace pagoda::hlod
