/* Choices that scenes make and engines obey: shared by the floors on both sides. */
#ifndef SUNDER_EFFECT_KINDS_H
#define SUNDER_EFFECT_KINDS_H

/* What a particle's velocity carries between steps (METHOD.md §3). */
typedef enum transfer_kind { TRANSFER_APIC, TRANSFER_RPIC, TRANSFER_PIC, TRANSFER_FLIP } transfer_kind;

/* B-splines. */
typedef enum kernel_kind { KERNEL_QUADRATIC, KERNEL_CUBIC } kernel_kind;

#endif
