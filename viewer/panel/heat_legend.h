// HeatLegend: what the colours of a heat map mean, with numbers.
#pragma once

#include "common/trace/heat_map.h"
#include "viewer/panel/style.h"

namespace mdk {

/// A strip of colours over the panel's width, from 0 to the top of the scale, and its unit.
void draw_heat_legend(const Theme& theme, const HeatScale& heat);

}  // namespace mdk
