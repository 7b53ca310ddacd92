/// The themes of the battery: each file adds its rows of the table of hard cases.
#pragma once

#include "framework/cli/battery.h"

namespace tumble::battery {

void add_springs(std::vector<Case>& cases);
void add_chains(std::vector<Case>& cases);
void add_tops(std::vector<Case>& cases);
void add_rotation(std::vector<Case>& cases);
void add_meshes(std::vector<Case>& cases);
void add_impacts(std::vector<Case>& cases);
void add_sweeps(std::vector<Case>& cases);
void add_scales(std::vector<Case>& cases);
void add_loops(std::vector<Case>& cases);
void add_stacks(std::vector<Case>& cases);
void add_cards(std::vector<Case>& cases);
void add_structures(std::vector<Case>& cases);
void add_friction(std::vector<Case>& cases);
void add_piles(std::vector<Case>& cases);
void add_rollbacks(std::vector<Case>& cases);

/// Of row 13: points, edges and what lies half over an edge (spikes.cpp).
void spikes(const Given& given, Findings& findings);

/// Of row 31: bodies with a curved surface (rattleback.cpp).
void rattleback(const Given& given, Findings& findings);

/// Why a measure of a row is known not to be reached; empty: it must be. The one list of shortfalls
/// (shortfalls.cpp).
std::string known_shortfall(int row, const std::string& what, bool is_long);

}  // namespace tumble::battery
