// What a results file or a model holds, as tables for spreadsheets and scripts.
#pragma once

#include "format/model/results.hpp"
#include "solver/base/csv_table.hpp"

namespace iga::solve {

/// Takes one table after the other; what they are made from lives only during the call.
using TableVisitor = std::function<void(const CsvTable&)>;

/// Tables of a results file, the main one first:
/// eigen: frequencies, surface, triangles; static: reactions, loads, probes, points, line_NAME and linearised_NAME for
/// each line, surface, triangles (principal stresses, largest first, beside all stresses);
/// explicit: energy, contact_NAME, body_NAME, rigid_NAME, support_NAME, then for each body and step of fields
/// surface_NAME_0001 …, and triangles_NAME.
/// Units stand in brackets behind the names, with the model's length unit where it has one.
/// @param file  the results file: fields of explicit runs lie in files beside it
/// @throws InputError, FormatError for field files that are missing or damaged
void visit_tables(const std::filesystem::path& file, const Results& results, const TableVisitor& visit);
/// Tables of a model: points, surface_points, spans, functions.
void visit_tables(const TrimmedModel& model, const TableVisitor& visit);

} // namespace iga::solve
