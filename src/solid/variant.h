/* Every file of the solid engine is compiled once a variant; these names keep the variants' symbols apart. */
#ifndef SUNDER_SOLID_VARIANT_H
#define SUNDER_SOLID_VARIANT_H

#include "base/simd.h"

#define SOLID_PASTE_(name, precision, simd) name##_f##precision##_##simd
#define SOLID_PASTE(name, precision, simd) SOLID_PASTE_(name, precision, simd)
#if SUNDER_SIMD == 2
#define SOLID_SIMD_NAME avx512
#elif SUNDER_SIMD == 1
#define SOLID_SIMD_NAME avx2
#else
#define SOLID_SIMD_NAME plain
#endif
#define SOLID_VARIANT(name) SOLID_PASTE(name, SUNDER_PRECISION, SOLID_SIMD_NAME)

#define solid_engine_table SOLID_VARIANT(solid_engine_table)
#define solid_tetra_table SOLID_VARIANT(solid_tetra_table)
#define solid_stage_names SOLID_VARIANT(solid_stage_names)
#define tetra_load SOLID_VARIANT(tetra_load)
#define tetra_free SOLID_VARIANT(tetra_free)
#define tetra_measure SOLID_VARIANT(tetra_measure)
#define tetra_read SOLID_VARIANT(tetra_read)
#define tetra_components SOLID_VARIANT(tetra_components)
#define tetra_save SOLID_VARIANT(tetra_save)
#define tetra_restore SOLID_VARIANT(tetra_restore)
#define tetra_deform SOLID_VARIANT(tetra_deform)
#define particles_reserve SOLID_VARIANT(particles_reserve)
#define particles_free SOLID_VARIANT(particles_free)
#define particles_load SOLID_VARIANT(particles_load)
#define particles_read SOLID_VARIANT(particles_read)
#define particles_push SOLID_VARIANT(particles_push)
#define order_reserve_hash SOLID_VARIANT(order_reserve_hash)
#define order_clear_hash SOLID_VARIANT(order_clear_hash)
#define order_grow SOLID_VARIANT(order_grow)
#define order_reserve_tiles SOLID_VARIANT(order_reserve_tiles)
#define order_insert SOLID_VARIANT(order_insert)
#define order_rank SOLID_VARIANT(order_rank)
#define order_rank_all SOLID_VARIANT(order_rank_all)
#define order_sort_keys SOLID_VARIANT(order_sort_keys)
#define order_add_block SOLID_VARIANT(order_add_block)
#define order_add_run SOLID_VARIANT(order_add_run)
#define particles_bytes SOLID_VARIANT(particles_bytes)
#define order_build_tiles SOLID_VARIANT(order_build_tiles)
#define particles_sort SOLID_VARIANT(particles_sort)
#define grid_build SOLID_VARIANT(grid_build)
#define grid_free SOLID_VARIANT(grid_free)
#define grid_update SOLID_VARIANT(grid_update)
#define grid_collect_results SOLID_VARIANT(grid_collect_results)
#define colours_assign SOLID_VARIANT(colours_assign)
#define colours_pass SOLID_VARIANT(colours_pass)
#define constraint_reserve SOLID_VARIANT(constraint_reserve)
#define constraint_free SOLID_VARIANT(constraint_free)
#define constraint_bytes SOLID_VARIANT(constraint_bytes)
#define constraint_is_slow SOLID_VARIANT(constraint_is_slow)
#define constraint_solved SOLID_VARIANT(constraint_solved)
#define constraint_precondition SOLID_VARIANT(constraint_precondition)
#define constraint_map SOLID_VARIANT(constraint_map)
#define constraint_begin_frame SOLID_VARIANT(constraint_begin_frame)
#define constraint_forget SOLID_VARIANT(constraint_forget)
#define constraint_weight SOLID_VARIANT(constraint_weight)
#define constraint_relaxation SOLID_VARIANT(constraint_relaxation)
#define constraint_assemble SOLID_VARIANT(constraint_assemble)
#define constraint_sweep SOLID_VARIANT(constraint_sweep)
#define constraint_solve SOLID_VARIANT(constraint_solve)
#define transfer_to_grid SOLID_VARIANT(transfer_to_grid)
#define transfer_to_particles SOLID_VARIANT(transfer_to_particles)
#define implicit_reserve SOLID_VARIANT(implicit_reserve)
#define implicit_free SOLID_VARIANT(implicit_free)
#define implicit_solve SOLID_VARIANT(implicit_solve)
#define implicit_load_window SOLID_VARIANT(implicit_load_window)
#define implicit_gather SOLID_VARIANT(implicit_gather)
#define transfer_limits SOLID_VARIANT(transfer_limits)
#define diffusion_reserve SOLID_VARIANT(diffusion_reserve)
#define diffusion_free SOLID_VARIANT(diffusion_free)
#define diffusion_start SOLID_VARIANT(diffusion_start)
#define diffusion_refresh SOLID_VARIANT(diffusion_refresh)
#define diffusion_feed SOLID_VARIANT(diffusion_feed)
#define diffusion_settle SOLID_VARIANT(diffusion_settle)
#define diffusion_capacity SOLID_VARIANT(diffusion_capacity)
#define solid_measure SOLID_VARIANT(solid_measure)
#define solid_save SOLID_VARIANT(solid_save)
#define solid_restore SOLID_VARIANT(solid_restore)
#define solid_read SOLID_VARIANT(solid_read)
#define solid_constants_refresh SOLID_VARIANT(solid_constants_refresh)

#endif
