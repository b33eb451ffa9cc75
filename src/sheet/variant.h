/* Every file of the sheet engine but a few is compiled once a variant; these names keep the variants' symbols apart. */
#ifndef SUNDER_SHEET_VARIANT_H
#define SUNDER_SHEET_VARIANT_H

#include "base/simd.h"

#define SHEET_PASTE_(name, precision, simd) name##_f##precision##_##simd
#define SHEET_PASTE(name, precision, simd) SHEET_PASTE_(name, precision, simd)
#if SUNDER_SIMD == 2
#define SHEET_SIMD_NAME avx512
#elif SUNDER_SIMD == 1
#define SHEET_SIMD_NAME avx2
#else
#define SHEET_SIMD_NAME plain
#endif
#define SHEET_VARIANT(name) SHEET_PASTE(name, SUNDER_PRECISION, SHEET_SIMD_NAME)

#define sheet_effect_table SHEET_VARIANT(sheet_effect_table)
#define sheet_engine_table SHEET_VARIANT(sheet_engine_table)
#define sheet_touch_table SHEET_VARIANT(sheet_touch_table)
#define sheet_layout SHEET_VARIANT(sheet_layout)
#define sheet_refill SHEET_VARIANT(sheet_refill)
#define sheet_layout_free SHEET_VARIANT(sheet_layout_free)
#define sheet_advance SHEET_VARIANT(sheet_advance)
#define sheet_take_hold SHEET_VARIANT(sheet_take_hold)
#define sheet_break_bonds SHEET_VARIANT(sheet_break_bonds)
#define sheet_for_packs SHEET_VARIANT(sheet_for_packs)
#define sheet_rates_create SHEET_VARIANT(sheet_rates_create)
#define sheet_rates_load SHEET_VARIANT(sheet_rates_load)
#define sheet_rates_free SHEET_VARIANT(sheet_rates_free)
#define sheet_rates_bytes SHEET_VARIANT(sheet_rates_bytes)
#define sheet_rates_limit SHEET_VARIANT(sheet_rates_limit)
#define sheet_rates_feel SHEET_VARIANT(sheet_rates_feel)
#define sheet_rates_choose SHEET_VARIANT(sheet_rates_choose)
#define sheet_rates_report SHEET_VARIANT(sheet_rates_report)
#define sheet_rates_levels SHEET_VARIANT(sheet_rates_levels)
#define sheet_for_due SHEET_VARIANT(sheet_for_due)
#define sheet_diffuse SHEET_VARIANT(sheet_diffuse)
#define sheet_measure SHEET_VARIANT(sheet_measure)
#define sheet_read SHEET_VARIANT(sheet_read)
#define sheet_bonds SHEET_VARIANT(sheet_bonds)
#define sheet_save SHEET_VARIANT(sheet_save)
#define sheet_restore SHEET_VARIANT(sheet_restore)

#endif
