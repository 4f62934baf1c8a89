	.file	"x.cpp"
	.file	1 "/usr/include/x86_64-linux-gnu/bits" "types.h"
	.file	2 "/usr/include/x86_64-linux-gnu/bits" "stdint-intn.h"
	.file	3 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cstdint"
	.file	4 "/usr/include/x86_64-linux-gnu/bits" "stdint-uintn.h"
	.file	5 "/usr/include" "stdint.h"
	.file	6 "/usr/include" "string.h"
	.file	7 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/include/__stddef_size_t.h"
	.file	8 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cstring"
	.file	9 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/__chrono/duration.h"
	.file	10 "/usr/include/x86_64-linux-gnu/bits/types" "clock_t.h"
	.file	11 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/ctime"
	.file	12 "/usr/include/x86_64-linux-gnu/bits/types" "time_t.h"
	.file	13 "/usr/include/x86_64-linux-gnu/bits/types" "struct_tm.h"
	.file	14 "/usr/include/x86_64-linux-gnu/bits/types" "struct_timespec.h"
	.file	15 "/usr/include" "time.h"
	.file	16 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/__math/traits.h"
	.file	17 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/math.h"
	.file	18 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/__math/modulo.h"
	.file	19 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cmath"
	.file	20 "/usr/include" "math.h"
	.file	21 "/usr/include/x86_64-linux-gnu/bits" "mathcalls.h"
	.file	22 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/include/__stddef_max_align_t.h"
	.file	23 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/__cstddef/max_align_t.h"
	.file	24 "/usr/include" "stdlib.h"
	.file	25 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cstdlib"
	.file	26 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/stdlib.h"
	.file	27 "/usr/include/x86_64-linux-gnu/bits/types" "__mbstate_t.h"
	.file	28 "/usr/include/x86_64-linux-gnu/bits/types" "mbstate_t.h"
	.file	29 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/__std_mbstate_t.h"
	.file	30 "/usr/include" "ctype.h"
	.file	31 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cctype"
	.file	32 "/usr/include/x86_64-linux-gnu/bits/types" "wint_t.h"
	.file	33 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cwctype"
	.file	34 "/usr/include" "wctype.h"
	.file	35 "/usr/include/x86_64-linux-gnu/bits" "wctype-wchar.h"
	.file	36 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cwchar"
	.file	37 "/usr/include/x86_64-linux-gnu/bits/types" "FILE.h"
	.file	38 "/usr/include" "wchar.h"
	.file	39 "/usr/include/x86_64-linux-gnu/bits/types" "__FILE.h"
	.file	40 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cstdio"
	.file	41 "/usr/include/x86_64-linux-gnu/bits/types" "__fpos_t.h"
	.file	42 "/usr/include" "stdio.h"
	.file	43 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/clocale"
	.file	44 "/usr/include" "locale.h"
	.file	45 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/include/__stdarg_va_list.h"
	.file	46 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/cstdarg"
	.file	47 "/tmp" "dem3d/zig/lib/python3.11/site-packages/ziglang/lib/libcxx/include/__chrono/literals.h"
	.section	.debug_abbrev,"",@progbits
	.byte	1                               # Abbreviation Code
	.byte	17                              # DW_TAG_compile_unit
	.byte	1                               # DW_CHILDREN_yes
	.byte	37                              # DW_AT_producer
	.byte	14                              # DW_FORM_strp
	.byte	19                              # DW_AT_language
	.byte	5                               # DW_FORM_data2
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	16                              # DW_AT_stmt_list
	.byte	23                              # DW_FORM_sec_offset
	.byte	27                              # DW_AT_comp_dir
	.byte	14                              # DW_FORM_strp
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	2                               # Abbreviation Code
	.byte	57                              # DW_TAG_namespace
	.byte	1                               # DW_CHILDREN_yes
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	3                               # Abbreviation Code
	.byte	57                              # DW_TAG_namespace
	.byte	1                               # DW_CHILDREN_yes
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.ascii	"\211\001"                      # DW_AT_export_symbols
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	4                               # Abbreviation Code
	.byte	8                               # DW_TAG_imported_declaration
	.byte	0                               # DW_CHILDREN_no
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	24                              # DW_AT_import
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	5                               # Abbreviation Code
	.byte	58                              # DW_TAG_imported_module
	.byte	0                               # DW_CHILDREN_no
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	24                              # DW_AT_import
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	6                               # Abbreviation Code
	.byte	58                              # DW_TAG_imported_module
	.byte	0                               # DW_CHILDREN_no
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	24                              # DW_AT_import
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	7                               # Abbreviation Code
	.byte	57                              # DW_TAG_namespace
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.ascii	"\211\001"                      # DW_AT_export_symbols
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	8                               # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	1                               # DW_CHILDREN_yes
	.byte	110                             # DW_AT_linkage_name
	.byte	14                              # DW_FORM_strp
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	9                               # Abbreviation Code
	.byte	5                               # DW_TAG_formal_parameter
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	10                              # Abbreviation Code
	.byte	8                               # DW_TAG_imported_declaration
	.byte	0                               # DW_CHILDREN_no
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	24                              # DW_AT_import
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	11                              # Abbreviation Code
	.byte	22                              # DW_TAG_typedef
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	12                              # Abbreviation Code
	.byte	36                              # DW_TAG_base_type
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	62                              # DW_AT_encoding
	.byte	11                              # DW_FORM_data1
	.byte	11                              # DW_AT_byte_size
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	13                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	1                               # DW_CHILDREN_yes
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	14                              # Abbreviation Code
	.byte	15                              # DW_TAG_pointer_type
	.byte	0                               # DW_CHILDREN_no
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	15                              # Abbreviation Code
	.byte	55                              # DW_TAG_restrict_type
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	16                              # Abbreviation Code
	.byte	15                              # DW_TAG_pointer_type
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	17                              # Abbreviation Code
	.byte	38                              # DW_TAG_const_type
	.byte	0                               # DW_CHILDREN_no
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	18                              # Abbreviation Code
	.byte	38                              # DW_TAG_const_type
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	19                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	1                               # DW_CHILDREN_yes
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	20                              # Abbreviation Code
	.byte	19                              # DW_TAG_structure_type
	.byte	1                               # DW_CHILDREN_yes
	.byte	54                              # DW_AT_calling_convention
	.byte	11                              # DW_FORM_data1
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	11                              # DW_AT_byte_size
	.byte	11                              # DW_FORM_data1
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	21                              # Abbreviation Code
	.byte	13                              # DW_TAG_member
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	56                              # DW_AT_data_member_location
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	22                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	23                              # Abbreviation Code
	.byte	19                              # DW_TAG_structure_type
	.byte	1                               # DW_CHILDREN_yes
	.byte	54                              # DW_AT_calling_convention
	.byte	11                              # DW_FORM_data1
	.byte	11                              # DW_AT_byte_size
	.byte	11                              # DW_FORM_data1
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	24                              # Abbreviation Code
	.byte	13                              # DW_TAG_member
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.ascii	"\210\001"                      # DW_AT_alignment
	.byte	15                              # DW_FORM_udata
	.byte	56                              # DW_AT_data_member_location
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	25                              # Abbreviation Code
	.byte	19                              # DW_TAG_structure_type
	.byte	0                               # DW_CHILDREN_no
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	26                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	27                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	1                               # DW_CHILDREN_yes
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	28                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.ascii	"\207\001"                      # DW_AT_noreturn
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	29                              # Abbreviation Code
	.byte	21                              # DW_TAG_subroutine_type
	.byte	0                               # DW_CHILDREN_no
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	30                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	1                               # DW_CHILDREN_yes
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.ascii	"\207\001"                      # DW_AT_noreturn
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	31                              # Abbreviation Code
	.byte	22                              # DW_TAG_typedef
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	32                              # Abbreviation Code
	.byte	21                              # DW_TAG_subroutine_type
	.byte	1                               # DW_CHILDREN_yes
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	33                              # Abbreviation Code
	.byte	23                              # DW_TAG_union_type
	.byte	1                               # DW_CHILDREN_yes
	.byte	54                              # DW_AT_calling_convention
	.byte	11                              # DW_FORM_data1
	.byte	11                              # DW_AT_byte_size
	.byte	11                              # DW_FORM_data1
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	34                              # Abbreviation Code
	.byte	1                               # DW_TAG_array_type
	.byte	1                               # DW_CHILDREN_yes
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	35                              # Abbreviation Code
	.byte	33                              # DW_TAG_subrange_type
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	55                              # DW_AT_count
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	36                              # Abbreviation Code
	.byte	36                              # DW_TAG_base_type
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	11                              # DW_AT_byte_size
	.byte	11                              # DW_FORM_data1
	.byte	62                              # DW_AT_encoding
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	37                              # Abbreviation Code
	.byte	19                              # DW_TAG_structure_type
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	38                              # Abbreviation Code
	.byte	24                              # DW_TAG_unspecified_parameters
	.byte	0                               # DW_CHILDREN_no
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	39                              # Abbreviation Code
	.byte	46                              # DW_TAG_subprogram
	.byte	1                               # DW_CHILDREN_yes
	.byte	110                             # DW_AT_linkage_name
	.byte	14                              # DW_FORM_strp
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	58                              # DW_AT_decl_file
	.byte	11                              # DW_FORM_data1
	.byte	59                              # DW_AT_decl_line
	.byte	5                               # DW_FORM_data2
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	60                              # DW_AT_declaration
	.byte	25                              # DW_FORM_flag_present
	.byte	63                              # DW_AT_external
	.byte	25                              # DW_FORM_flag_present
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	40                              # Abbreviation Code
	.byte	19                              # DW_TAG_structure_type
	.byte	1                               # DW_CHILDREN_yes
	.byte	54                              # DW_AT_calling_convention
	.byte	11                              # DW_FORM_data1
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	11                              # DW_AT_byte_size
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	41                              # Abbreviation Code
	.byte	13                              # DW_TAG_member
	.byte	0                               # DW_CHILDREN_no
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	56                              # DW_AT_data_member_location
	.byte	11                              # DW_FORM_data1
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	42                              # Abbreviation Code
	.byte	22                              # DW_TAG_typedef
	.byte	0                               # DW_CHILDREN_no
	.byte	73                              # DW_AT_type
	.byte	19                              # DW_FORM_ref4
	.byte	3                               # DW_AT_name
	.byte	14                              # DW_FORM_strp
	.byte	0                               # EOM(1)
	.byte	0                               # EOM(2)
	.byte	0                               # EOM(3)
	.section	.debug_info,"",@progbits
.Lcu_begin0:
	.long	.Ldebug_info_end0-.Ldebug_info_start0 # Length of Unit
.Ldebug_info_start0:
	.short	4                               # DWARF version number
	.long	.debug_abbrev                   # Offset Into Abbrev. Section
	.byte	8                               # Address Size (in bytes)
	.byte	1                               # Abbrev [1] 0xb:0x2c69 DW_TAG_compile_unit
	.long	.Linfo_string0                  # DW_AT_producer
	.short	33                              # DW_AT_language
	.long	.Linfo_string1                  # DW_AT_name
	.long	.Lline_table_start0             # DW_AT_stmt_list
	.long	.Linfo_string2                  # DW_AT_comp_dir
	.byte	2                               # Abbrev [2] 0x1e:0xb77 DW_TAG_namespace
	.long	.Linfo_string3                  # DW_AT_name
	.byte	3                               # Abbrev [3] 0x23:0xb71 DW_TAG_namespace
	.long	.Linfo_string4                  # DW_AT_name
                                        # DW_AT_export_symbols
	.byte	4                               # Abbrev [4] 0x28:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	158                             # DW_AT_decl_line
	.long	2965                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x2f:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	2994                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x36:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	160                             # DW_AT_decl_line
	.long	3023                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x3d:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	161                             # DW_AT_decl_line
	.long	3052                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x44:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	163                             # DW_AT_decl_line
	.long	3081                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x4b:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	164                             # DW_AT_decl_line
	.long	3110                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x52:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	165                             # DW_AT_decl_line
	.long	3139                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x59:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	166                             # DW_AT_decl_line
	.long	3168                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x60:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	168                             # DW_AT_decl_line
	.long	3197                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x67:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	169                             # DW_AT_decl_line
	.long	3219                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6e:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	170                             # DW_AT_decl_line
	.long	3241                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x75:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	171                             # DW_AT_decl_line
	.long	3263                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7c:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	173                             # DW_AT_decl_line
	.long	3285                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x83:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	174                             # DW_AT_decl_line
	.long	3307                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8a:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	175                             # DW_AT_decl_line
	.long	3329                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x91:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	176                             # DW_AT_decl_line
	.long	3351                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x98:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	178                             # DW_AT_decl_line
	.long	3373                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9f:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	179                             # DW_AT_decl_line
	.long	3384                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa6:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	180                             # DW_AT_decl_line
	.long	3395                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xad:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	181                             # DW_AT_decl_line
	.long	3406                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb4:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	183                             # DW_AT_decl_line
	.long	3417                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xbb:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	184                             # DW_AT_decl_line
	.long	3428                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xc2:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	185                             # DW_AT_decl_line
	.long	3439                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xc9:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	186                             # DW_AT_decl_line
	.long	3450                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xd0:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	188                             # DW_AT_decl_line
	.long	3461                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xd7:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	189                             # DW_AT_decl_line
	.long	3472                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xde:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	191                             # DW_AT_decl_line
	.long	3483                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xe5:0x7 DW_TAG_imported_declaration
	.byte	3                               # DW_AT_decl_file
	.byte	192                             # DW_AT_decl_line
	.long	3505                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xec:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	82                              # DW_AT_decl_line
	.long	3527                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xf3:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	83                              # DW_AT_decl_line
	.long	3582                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xfa:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	84                              # DW_AT_decl_line
	.long	3609                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x101:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	85                              # DW_AT_decl_line
	.long	3663                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x108:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	86                              # DW_AT_decl_line
	.long	3690                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x10f:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	87                              # DW_AT_decl_line
	.long	3712                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x116:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	88                              # DW_AT_decl_line
	.long	3739                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x11d:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	89                              # DW_AT_decl_line
	.long	3766                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x124:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	90                              # DW_AT_decl_line
	.long	3788                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x12b:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	91                              # DW_AT_decl_line
	.long	3815                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x132:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	92                              # DW_AT_decl_line
	.long	3837                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x139:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	93                              # DW_AT_decl_line
	.long	3864                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x140:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	94                              # DW_AT_decl_line
	.long	3891                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x147:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	95                              # DW_AT_decl_line
	.long	3913                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x14e:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	96                              # DW_AT_decl_line
	.long	3936                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x155:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	97                              # DW_AT_decl_line
	.long	3959                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x15c:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	98                              # DW_AT_decl_line
	.long	3981                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x163:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	99                              # DW_AT_decl_line
	.long	4004                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x16a:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	100                             # DW_AT_decl_line
	.long	4027                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x171:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	101                             # DW_AT_decl_line
	.long	4050                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x178:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	102                             # DW_AT_decl_line
	.long	4077                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x17f:0x7 DW_TAG_imported_declaration
	.byte	8                               # DW_AT_decl_file
	.byte	103                             # DW_AT_decl_line
	.long	4095                            # DW_AT_import
	.byte	2                               # Abbrev [2] 0x186:0x15 DW_TAG_namespace
	.long	.Linfo_string83                 # DW_AT_name
	.byte	5                               # Abbrev [5] 0x18b:0x8 DW_TAG_imported_module
	.byte	9                               # DW_AT_decl_file
	.short	549                             # DW_AT_decl_line
	.long	416                             # DW_AT_import
	.byte	6                               # Abbrev [6] 0x193:0x7 DW_TAG_imported_module
	.byte	47                              # DW_AT_decl_file
	.byte	38                              # DW_AT_decl_line
	.long	416                             # DW_AT_import
	.byte	0                               # End Of Children Mark
	.byte	3                               # Abbrev [3] 0x19b:0xb DW_TAG_namespace
	.long	.Linfo_string84                 # DW_AT_name
                                        # DW_AT_export_symbols
	.byte	7                               # Abbrev [7] 0x1a0:0x5 DW_TAG_namespace
	.long	.Linfo_string85                 # DW_AT_name
                                        # DW_AT_export_symbols
	.byte	0                               # End Of Children Mark
	.byte	4                               # Abbrev [4] 0x1a6:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	68                              # DW_AT_decl_line
	.long	4113                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1ad:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	69                              # DW_AT_decl_line
	.long	4135                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1b4:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	70                              # DW_AT_decl_line
	.long	4157                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1bb:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	72                              # DW_AT_decl_line
	.long	4299                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1c2:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	74                              # DW_AT_decl_line
	.long	4344                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1c9:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	75                              # DW_AT_decl_line
	.long	4355                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1d0:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	76                              # DW_AT_decl_line
	.long	4384                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1d7:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	77                              # DW_AT_decl_line
	.long	4406                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1de:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	78                              # DW_AT_decl_line
	.long	4428                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1e5:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	79                              # DW_AT_decl_line
	.long	4455                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1ec:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	80                              # DW_AT_decl_line
	.long	4482                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1f3:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	81                              # DW_AT_decl_line
	.long	4499                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x1fa:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	82                              # DW_AT_decl_line
	.long	4516                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x201:0x7 DW_TAG_imported_declaration
	.byte	11                              # DW_AT_decl_file
	.byte	84                              # DW_AT_decl_line
	.long	4553                            # DW_AT_import
	.byte	2                               # Abbrev [2] 0x208:0x74 DW_TAG_namespace
	.long	.Linfo_string117                # DW_AT_name
	.byte	8                               # Abbrev [8] 0x20d:0x15 DW_TAG_subprogram
	.long	.Linfo_string118                # DW_AT_linkage_name
	.long	.Linfo_string119                # DW_AT_name
	.byte	16                              # DW_AT_decl_file
	.byte	66                              # DW_AT_decl_line
	.long	4581                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x21c:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	8                               # Abbrev [8] 0x222:0x15 DW_TAG_subprogram
	.long	.Linfo_string122                # DW_AT_linkage_name
	.long	.Linfo_string123                # DW_AT_name
	.byte	16                              # DW_AT_decl_file
	.byte	90                              # DW_AT_decl_line
	.long	4581                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x231:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	8                               # Abbrev [8] 0x237:0x15 DW_TAG_subprogram
	.long	.Linfo_string124                # DW_AT_linkage_name
	.long	.Linfo_string125                # DW_AT_name
	.byte	16                              # DW_AT_decl_file
	.byte	114                             # DW_AT_decl_line
	.long	4581                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x246:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	8                               # Abbrev [8] 0x24c:0x15 DW_TAG_subprogram
	.long	.Linfo_string126                # DW_AT_linkage_name
	.long	.Linfo_string127                # DW_AT_name
	.byte	16                              # DW_AT_decl_file
	.byte	133                             # DW_AT_decl_line
	.long	4581                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x25b:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	8                               # Abbrev [8] 0x261:0x1a DW_TAG_subprogram
	.long	.Linfo_string128                # DW_AT_linkage_name
	.long	.Linfo_string129                # DW_AT_name
	.byte	18                              # DW_AT_decl_file
	.byte	55                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x270:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x275:0x5 DW_TAG_formal_parameter
	.long	4627                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	0                               # End Of Children Mark
	.byte	10                              # Abbrev [10] 0x27c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	352                             # DW_AT_decl_line
	.long	525                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x284:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	353                             # DW_AT_decl_line
	.long	546                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x28c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	354                             # DW_AT_decl_line
	.long	567                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x294:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	355                             # DW_AT_decl_line
	.long	588                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x29c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	364                             # DW_AT_decl_line
	.long	4640                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2a4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	365                             # DW_AT_decl_line
	.long	4658                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2ac:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	370                             # DW_AT_decl_line
	.long	4669                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2b4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	372                             # DW_AT_decl_line
	.long	4686                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2bc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	374                             # DW_AT_decl_line
	.long	4703                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2c4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	376                             # DW_AT_decl_line
	.long	4720                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2cc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	378                             # DW_AT_decl_line
	.long	4742                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2d4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	380                             # DW_AT_decl_line
	.long	4759                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2dc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	382                             # DW_AT_decl_line
	.long	4776                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2e4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	385                             # DW_AT_decl_line
	.long	4793                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2ec:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	388                             # DW_AT_decl_line
	.long	4810                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2f4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	390                             # DW_AT_decl_line
	.long	4827                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x2fc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	393                             # DW_AT_decl_line
	.long	4844                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x304:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	396                             # DW_AT_decl_line
	.long	4866                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x30c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	398                             # DW_AT_decl_line
	.long	4893                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x314:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	401                             # DW_AT_decl_line
	.long	4915                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x31c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	404                             # DW_AT_decl_line
	.long	4932                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x324:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	405                             # DW_AT_decl_line
	.long	609                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x32c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	406                             # DW_AT_decl_line
	.long	4949                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x334:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	409                             # DW_AT_decl_line
	.long	4976                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x33c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	412                             # DW_AT_decl_line
	.long	4998                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x344:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	414                             # DW_AT_decl_line
	.long	5015                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x34c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	417                             # DW_AT_decl_line
	.long	5032                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x354:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	419                             # DW_AT_decl_line
	.long	5049                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x35c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	422                             # DW_AT_decl_line
	.long	5066                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x364:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	425                             # DW_AT_decl_line
	.long	5083                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x36c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	427                             # DW_AT_decl_line
	.long	5100                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x374:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	429                             # DW_AT_decl_line
	.long	5117                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x37c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	431                             # DW_AT_decl_line
	.long	5134                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x384:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	434                             # DW_AT_decl_line
	.long	5151                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x38c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	437                             # DW_AT_decl_line
	.long	5173                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x394:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	439                             # DW_AT_decl_line
	.long	5190                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x39c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	441                             # DW_AT_decl_line
	.long	5207                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3a4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	443                             # DW_AT_decl_line
	.long	5224                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3ac:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	445                             # DW_AT_decl_line
	.long	5241                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3b4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	446                             # DW_AT_decl_line
	.long	5264                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3bc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	449                             # DW_AT_decl_line
	.long	5292                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3c4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	451                             # DW_AT_decl_line
	.long	5315                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3cc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	453                             # DW_AT_decl_line
	.long	5338                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3d4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	455                             # DW_AT_decl_line
	.long	5360                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3dc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	457                             # DW_AT_decl_line
	.long	5378                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3e4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	459                             # DW_AT_decl_line
	.long	5395                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3ec:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	461                             # DW_AT_decl_line
	.long	5420                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3f4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	463                             # DW_AT_decl_line
	.long	5438                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x3fc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	465                             # DW_AT_decl_line
	.long	5455                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x404:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	467                             # DW_AT_decl_line
	.long	5472                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x40c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	469                             # DW_AT_decl_line
	.long	5489                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x414:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	471                             # DW_AT_decl_line
	.long	5507                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x41c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	473                             # DW_AT_decl_line
	.long	5525                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x424:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	474                             # DW_AT_decl_line
	.long	5542                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x42c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	477                             # DW_AT_decl_line
	.long	5559                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x434:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	479                             # DW_AT_decl_line
	.long	5577                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x43c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	481                             # DW_AT_decl_line
	.long	5600                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x444:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	483                             # DW_AT_decl_line
	.long	5623                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x44c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	485                             # DW_AT_decl_line
	.long	5646                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x454:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	487                             # DW_AT_decl_line
	.long	5674                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x45c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	489                             # DW_AT_decl_line
	.long	5692                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x464:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	491                             # DW_AT_decl_line
	.long	5710                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x46c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	493                             # DW_AT_decl_line
	.long	5733                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x474:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	495                             # DW_AT_decl_line
	.long	5756                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x47c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	497                             # DW_AT_decl_line
	.long	5773                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x484:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	499                             # DW_AT_decl_line
	.long	5791                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x48c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	500                             # DW_AT_decl_line
	.long	5808                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x494:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	501                             # DW_AT_decl_line
	.long	5825                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x49c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	502                             # DW_AT_decl_line
	.long	5842                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4a4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	503                             # DW_AT_decl_line
	.long	5864                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4ac:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	504                             # DW_AT_decl_line
	.long	5881                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4b4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	505                             # DW_AT_decl_line
	.long	5898                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4bc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	506                             # DW_AT_decl_line
	.long	5915                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4c4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	507                             # DW_AT_decl_line
	.long	5932                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4cc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	508                             # DW_AT_decl_line
	.long	5949                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4d4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	509                             # DW_AT_decl_line
	.long	5966                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4dc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	510                             # DW_AT_decl_line
	.long	5988                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4e4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	511                             # DW_AT_decl_line
	.long	6010                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4ec:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	512                             # DW_AT_decl_line
	.long	6032                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4f4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	513                             # DW_AT_decl_line
	.long	6049                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x4fc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	514                             # DW_AT_decl_line
	.long	6066                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x504:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	515                             # DW_AT_decl_line
	.long	6088                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x50c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	516                             # DW_AT_decl_line
	.long	6110                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x514:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	517                             # DW_AT_decl_line
	.long	6127                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x51c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	518                             # DW_AT_decl_line
	.long	6144                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x524:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	519                             # DW_AT_decl_line
	.long	6161                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x52c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	521                             # DW_AT_decl_line
	.long	6178                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x534:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	522                             # DW_AT_decl_line
	.long	6195                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x53c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	523                             # DW_AT_decl_line
	.long	6212                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x544:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	524                             # DW_AT_decl_line
	.long	6229                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x54c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	525                             # DW_AT_decl_line
	.long	6246                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x554:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	527                             # DW_AT_decl_line
	.long	6263                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x55c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	529                             # DW_AT_decl_line
	.long	6285                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x564:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	530                             # DW_AT_decl_line
	.long	6302                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x56c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	531                             # DW_AT_decl_line
	.long	6319                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x574:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	532                             # DW_AT_decl_line
	.long	6336                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x57c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	533                             # DW_AT_decl_line
	.long	6353                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x584:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	534                             # DW_AT_decl_line
	.long	6376                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x58c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	535                             # DW_AT_decl_line
	.long	6404                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x594:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	536                             # DW_AT_decl_line
	.long	6427                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x59c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	537                             # DW_AT_decl_line
	.long	6450                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5a4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	538                             # DW_AT_decl_line
	.long	6472                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5ac:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	539                             # DW_AT_decl_line
	.long	6490                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5b4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	540                             # DW_AT_decl_line
	.long	6507                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5bc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	541                             # DW_AT_decl_line
	.long	6525                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5c4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	542                             # DW_AT_decl_line
	.long	6543                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5cc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	543                             # DW_AT_decl_line
	.long	6560                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5d4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	544                             # DW_AT_decl_line
	.long	6577                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5dc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	545                             # DW_AT_decl_line
	.long	6594                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5e4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	546                             # DW_AT_decl_line
	.long	6612                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5ec:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	547                             # DW_AT_decl_line
	.long	6630                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5f4:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	548                             # DW_AT_decl_line
	.long	6647                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x5fc:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	549                             # DW_AT_decl_line
	.long	6665                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x604:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	550                             # DW_AT_decl_line
	.long	6688                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x60c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	551                             # DW_AT_decl_line
	.long	6711                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x614:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	552                             # DW_AT_decl_line
	.long	6734                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x61c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	553                             # DW_AT_decl_line
	.long	6762                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x624:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	554                             # DW_AT_decl_line
	.long	6780                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x62c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	555                             # DW_AT_decl_line
	.long	6798                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x634:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	556                             # DW_AT_decl_line
	.long	6821                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x63c:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	557                             # DW_AT_decl_line
	.long	6844                            # DW_AT_import
	.byte	10                              # Abbrev [10] 0x644:0x8 DW_TAG_imported_declaration
	.byte	19                              # DW_AT_decl_file
	.short	558                             # DW_AT_decl_line
	.long	6861                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x64c:0x7 DW_TAG_imported_declaration
	.byte	23                              # DW_AT_decl_file
	.byte	22                              # DW_AT_decl_line
	.long	6879                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x653:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	106                             # DW_AT_decl_line
	.long	6922                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x65a:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	107                             # DW_AT_decl_line
	.long	6934                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x661:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	108                             # DW_AT_decl_line
	.long	6975                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x668:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	109                             # DW_AT_decl_line
	.long	7016                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x66f:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	110                             # DW_AT_decl_line
	.long	7033                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x676:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	111                             # DW_AT_decl_line
	.long	7050                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x67d:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	112                             # DW_AT_decl_line
	.long	7067                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x684:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	113                             # DW_AT_decl_line
	.long	7084                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x68b:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	114                             # DW_AT_decl_line
	.long	7116                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x692:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	115                             # DW_AT_decl_line
	.long	7138                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x699:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	116                             # DW_AT_decl_line
	.long	7160                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6a0:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	117                             # DW_AT_decl_line
	.long	7187                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6a7:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	118                             # DW_AT_decl_line
	.long	7214                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6ae:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	119                             # DW_AT_decl_line
	.long	7241                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6b5:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	120                             # DW_AT_decl_line
	.long	7275                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6bc:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	121                             # DW_AT_decl_line
	.long	7287                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6c3:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	122                             # DW_AT_decl_line
	.long	7301                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6ca:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	123                             # DW_AT_decl_line
	.long	7324                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6d1:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	124                             # DW_AT_decl_line
	.long	7338                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6d8:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	7356                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6df:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	126                             # DW_AT_decl_line
	.long	7379                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6e6:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	127                             # DW_AT_decl_line
	.long	7387                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6ed:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	128                             # DW_AT_decl_line
	.long	7411                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6f4:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	129                             # DW_AT_decl_line
	.long	7425                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x6fb:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	130                             # DW_AT_decl_line
	.long	7439                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x702:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	131                             # DW_AT_decl_line
	.long	7457                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x709:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	132                             # DW_AT_decl_line
	.long	7475                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x710:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	133                             # DW_AT_decl_line
	.long	7546                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x717:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	134                             # DW_AT_decl_line
	.long	7575                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x71e:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	135                             # DW_AT_decl_line
	.long	7593                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x725:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	136                             # DW_AT_decl_line
	.long	7611                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x72c:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	137                             # DW_AT_decl_line
	.long	7629                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x733:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	138                             # DW_AT_decl_line
	.long	7655                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x73a:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	139                             # DW_AT_decl_line
	.long	7678                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x741:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	140                             # DW_AT_decl_line
	.long	7701                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x748:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	142                             # DW_AT_decl_line
	.long	7724                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x74f:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	143                             # DW_AT_decl_line
	.long	7769                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x756:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	144                             # DW_AT_decl_line
	.long	7792                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x75d:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	145                             # DW_AT_decl_line
	.long	7820                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x764:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	148                             # DW_AT_decl_line
	.long	7863                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x76b:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	149                             # DW_AT_decl_line
	.long	7881                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x772:0x7 DW_TAG_imported_declaration
	.byte	25                              # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	7895                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x779:0x7 DW_TAG_imported_declaration
	.byte	29                              # DW_AT_decl_file
	.byte	25                              # DW_AT_decl_line
	.long	7918                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x780:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	113                             # DW_AT_decl_line
	.long	8019                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x787:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	114                             # DW_AT_decl_line
	.long	8036                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x78e:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	115                             # DW_AT_decl_line
	.long	8053                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x795:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	116                             # DW_AT_decl_line
	.long	8070                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x79c:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	117                             # DW_AT_decl_line
	.long	8087                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7a3:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	118                             # DW_AT_decl_line
	.long	8104                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7aa:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	119                             # DW_AT_decl_line
	.long	8121                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7b1:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	120                             # DW_AT_decl_line
	.long	8138                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7b8:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	121                             # DW_AT_decl_line
	.long	8155                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7bf:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	122                             # DW_AT_decl_line
	.long	8172                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7c6:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	123                             # DW_AT_decl_line
	.long	8189                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7cd:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	124                             # DW_AT_decl_line
	.long	8206                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7d4:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	8223                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7db:0x7 DW_TAG_imported_declaration
	.byte	31                              # DW_AT_decl_file
	.byte	126                             # DW_AT_decl_line
	.long	8240                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7e2:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	75                              # DW_AT_decl_line
	.long	8257                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7e9:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	76                              # DW_AT_decl_line
	.long	8268                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7f0:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	77                              # DW_AT_decl_line
	.long	8289                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7f7:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	78                              # DW_AT_decl_line
	.long	8300                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x7fe:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	79                              # DW_AT_decl_line
	.long	8317                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x805:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	80                              # DW_AT_decl_line
	.long	8334                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x80c:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	81                              # DW_AT_decl_line
	.long	8351                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x813:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	82                              # DW_AT_decl_line
	.long	8368                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x81a:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	83                              # DW_AT_decl_line
	.long	8385                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x821:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	84                              # DW_AT_decl_line
	.long	8402                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x828:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	85                              # DW_AT_decl_line
	.long	8419                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x82f:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	86                              # DW_AT_decl_line
	.long	8436                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x836:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	87                              # DW_AT_decl_line
	.long	8453                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x83d:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	88                              # DW_AT_decl_line
	.long	8470                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x844:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	89                              # DW_AT_decl_line
	.long	8487                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x84b:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	90                              # DW_AT_decl_line
	.long	8504                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x852:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	91                              # DW_AT_decl_line
	.long	8526                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x859:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	92                              # DW_AT_decl_line
	.long	8543                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x860:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	93                              # DW_AT_decl_line
	.long	8560                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x867:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	94                              # DW_AT_decl_line
	.long	8577                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x86e:0x7 DW_TAG_imported_declaration
	.byte	33                              # DW_AT_decl_file
	.byte	95                              # DW_AT_decl_line
	.long	8599                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x875:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	134                             # DW_AT_decl_line
	.long	7918                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x87c:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	135                             # DW_AT_decl_line
	.long	4157                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x883:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	136                             # DW_AT_decl_line
	.long	8257                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x88a:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	137                             # DW_AT_decl_line
	.long	8616                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x891:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	138                             # DW_AT_decl_line
	.long	8632                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x898:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	139                             # DW_AT_decl_line
	.long	8677                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x89f:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	140                             # DW_AT_decl_line
	.long	8705                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8a6:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	141                             # DW_AT_decl_line
	.long	8734                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8ad:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	142                             # DW_AT_decl_line
	.long	8815                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8b4:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	143                             # DW_AT_decl_line
	.long	8848                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8bb:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	144                             # DW_AT_decl_line
	.long	8876                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8c2:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	145                             # DW_AT_decl_line
	.long	8908                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8c9:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	146                             # DW_AT_decl_line
	.long	8940                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8d0:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	147                             # DW_AT_decl_line
	.long	8958                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8d7:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	148                             # DW_AT_decl_line
	.long	8986                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8de:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	149                             # DW_AT_decl_line
	.long	9009                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8e5:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	150                             # DW_AT_decl_line
	.long	9032                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8ec:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	151                             # DW_AT_decl_line
	.long	9055                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8f3:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	9073                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x8fa:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	153                             # DW_AT_decl_line
	.long	9096                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x901:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	154                             # DW_AT_decl_line
	.long	9119                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x908:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	155                             # DW_AT_decl_line
	.long	9152                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x90f:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	156                             # DW_AT_decl_line
	.long	9175                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x916:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	157                             # DW_AT_decl_line
	.long	9198                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x91d:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	158                             # DW_AT_decl_line
	.long	9226                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x924:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	9254                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x92b:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	160                             # DW_AT_decl_line
	.long	9282                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x932:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	161                             # DW_AT_decl_line
	.long	9310                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x939:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	162                             # DW_AT_decl_line
	.long	9332                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x940:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	163                             # DW_AT_decl_line
	.long	9359                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x947:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	164                             # DW_AT_decl_line
	.long	9381                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x94e:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	165                             # DW_AT_decl_line
	.long	9408                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x955:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	166                             # DW_AT_decl_line
	.long	9430                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x95c:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	167                             # DW_AT_decl_line
	.long	9452                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x963:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	168                             # DW_AT_decl_line
	.long	9479                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x96a:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	169                             # DW_AT_decl_line
	.long	9506                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x971:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	170                             # DW_AT_decl_line
	.long	9528                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x978:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	171                             # DW_AT_decl_line
	.long	9550                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x97f:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	172                             # DW_AT_decl_line
	.long	9572                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x986:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	173                             # DW_AT_decl_line
	.long	9594                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x98d:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	174                             # DW_AT_decl_line
	.long	9621                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x994:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	175                             # DW_AT_decl_line
	.long	9643                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x99b:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	176                             # DW_AT_decl_line
	.long	9660                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9a2:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	177                             # DW_AT_decl_line
	.long	9682                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9a9:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	178                             # DW_AT_decl_line
	.long	9709                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9b0:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	179                             # DW_AT_decl_line
	.long	9737                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9b7:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	180                             # DW_AT_decl_line
	.long	9765                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9be:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	181                             # DW_AT_decl_line
	.long	9793                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9c5:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	182                             # DW_AT_decl_line
	.long	9821                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9cc:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	183                             # DW_AT_decl_line
	.long	9854                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9d3:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	184                             # DW_AT_decl_line
	.long	9872                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9da:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	185                             # DW_AT_decl_line
	.long	9890                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9e1:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	186                             # DW_AT_decl_line
	.long	9918                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9e8:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	187                             # DW_AT_decl_line
	.long	9956                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9ef:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	188                             # DW_AT_decl_line
	.long	9989                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9f6:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	189                             # DW_AT_decl_line
	.long	10017                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0x9fd:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	190                             # DW_AT_decl_line
	.long	10060                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa04:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	192                             # DW_AT_decl_line
	.long	10103                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa0b:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	193                             # DW_AT_decl_line
	.long	10115                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa12:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	194                             # DW_AT_decl_line
	.long	10142                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa19:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	196                             # DW_AT_decl_line
	.long	10165                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa20:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	197                             # DW_AT_decl_line
	.long	10183                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa27:0x7 DW_TAG_imported_declaration
	.byte	36                              # DW_AT_decl_file
	.byte	198                             # DW_AT_decl_line
	.long	10206                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa2e:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	120                             # DW_AT_decl_line
	.long	8616                            # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa35:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	121                             # DW_AT_decl_line
	.long	10225                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa3c:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	123                             # DW_AT_decl_line
	.long	10252                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa43:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	124                             # DW_AT_decl_line
	.long	10274                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa4a:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	10291                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa51:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	126                             # DW_AT_decl_line
	.long	10315                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa58:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	127                             # DW_AT_decl_line
	.long	10348                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa5f:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	128                             # DW_AT_decl_line
	.long	10372                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa66:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	129                             # DW_AT_decl_line
	.long	10400                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa6d:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	130                             # DW_AT_decl_line
	.long	10429                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa74:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	131                             # DW_AT_decl_line
	.long	10453                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa7b:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	132                             # DW_AT_decl_line
	.long	10481                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa82:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	133                             # DW_AT_decl_line
	.long	10509                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa89:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	134                             # DW_AT_decl_line
	.long	10541                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa90:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	135                             # DW_AT_decl_line
	.long	10573                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa97:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	136                             # DW_AT_decl_line
	.long	10606                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xa9e:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	137                             # DW_AT_decl_line
	.long	10634                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xaa5:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	138                             # DW_AT_decl_line
	.long	10652                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xaac:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	139                             # DW_AT_decl_line
	.long	10680                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xab3:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	140                             # DW_AT_decl_line
	.long	10703                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xaba:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	141                             # DW_AT_decl_line
	.long	10726                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xac1:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	142                             # DW_AT_decl_line
	.long	10744                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xac8:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	143                             # DW_AT_decl_line
	.long	10767                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xacf:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	144                             # DW_AT_decl_line
	.long	10790                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xad6:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	145                             # DW_AT_decl_line
	.long	10823                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xadd:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	146                             # DW_AT_decl_line
	.long	10856                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xae4:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	147                             # DW_AT_decl_line
	.long	10889                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xaeb:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	148                             # DW_AT_decl_line
	.long	10917                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xaf2:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	149                             # DW_AT_decl_line
	.long	10950                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xaf9:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	150                             # DW_AT_decl_line
	.long	10968                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb00:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	151                             # DW_AT_decl_line
	.long	10982                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb07:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	10996                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb0e:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	153                             # DW_AT_decl_line
	.long	11014                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb15:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	154                             # DW_AT_decl_line
	.long	11032                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb1c:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	156                             # DW_AT_decl_line
	.long	11046                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb23:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	157                             # DW_AT_decl_line
	.long	11069                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb2a:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	158                             # DW_AT_decl_line
	.long	11097                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb31:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	11114                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb38:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	160                             # DW_AT_decl_line
	.long	11136                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb3f:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	161                             # DW_AT_decl_line
	.long	11147                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb46:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	163                             # DW_AT_decl_line
	.long	11164                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb4d:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	167                             # DW_AT_decl_line
	.long	11176                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb54:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	168                             # DW_AT_decl_line
	.long	11199                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb5b:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	170                             # DW_AT_decl_line
	.long	11226                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb62:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	171                             # DW_AT_decl_line
	.long	11245                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb69:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	172                             # DW_AT_decl_line
	.long	11263                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb70:0x7 DW_TAG_imported_declaration
	.byte	40                              # DW_AT_decl_file
	.byte	173                             # DW_AT_decl_line
	.long	11281                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb77:0x7 DW_TAG_imported_declaration
	.byte	43                              # DW_AT_decl_file
	.byte	52                              # DW_AT_decl_line
	.long	11304                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb7e:0x7 DW_TAG_imported_declaration
	.byte	43                              # DW_AT_decl_file
	.byte	53                              # DW_AT_decl_line
	.long	11309                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb85:0x7 DW_TAG_imported_declaration
	.byte	43                              # DW_AT_decl_file
	.byte	54                              # DW_AT_decl_line
	.long	11331                           # DW_AT_import
	.byte	4                               # Abbrev [4] 0xb8c:0x7 DW_TAG_imported_declaration
	.byte	46                              # DW_AT_decl_file
	.byte	53                              # DW_AT_decl_line
	.long	11347                           # DW_AT_import
	.byte	0                               # End Of Children Mark
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0xb95:0xb DW_TAG_typedef
	.long	2976                            # DW_AT_type
	.long	.Linfo_string7                  # DW_AT_name
	.byte	2                               # DW_AT_decl_file
	.byte	24                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xba0:0xb DW_TAG_typedef
	.long	2987                            # DW_AT_type
	.long	.Linfo_string6                  # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	37                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xbab:0x7 DW_TAG_base_type
	.long	.Linfo_string5                  # DW_AT_name
	.byte	6                               # DW_AT_encoding
	.byte	1                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xbb2:0xb DW_TAG_typedef
	.long	3005                            # DW_AT_type
	.long	.Linfo_string10                 # DW_AT_name
	.byte	2                               # DW_AT_decl_file
	.byte	25                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xbbd:0xb DW_TAG_typedef
	.long	3016                            # DW_AT_type
	.long	.Linfo_string9                  # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	39                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xbc8:0x7 DW_TAG_base_type
	.long	.Linfo_string8                  # DW_AT_name
	.byte	5                               # DW_AT_encoding
	.byte	2                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xbcf:0xb DW_TAG_typedef
	.long	3034                            # DW_AT_type
	.long	.Linfo_string13                 # DW_AT_name
	.byte	2                               # DW_AT_decl_file
	.byte	26                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xbda:0xb DW_TAG_typedef
	.long	3045                            # DW_AT_type
	.long	.Linfo_string12                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	41                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xbe5:0x7 DW_TAG_base_type
	.long	.Linfo_string11                 # DW_AT_name
	.byte	5                               # DW_AT_encoding
	.byte	4                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xbec:0xb DW_TAG_typedef
	.long	3063                            # DW_AT_type
	.long	.Linfo_string16                 # DW_AT_name
	.byte	2                               # DW_AT_decl_file
	.byte	27                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xbf7:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string15                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	44                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xc02:0x7 DW_TAG_base_type
	.long	.Linfo_string14                 # DW_AT_name
	.byte	5                               # DW_AT_encoding
	.byte	8                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xc09:0xb DW_TAG_typedef
	.long	3092                            # DW_AT_type
	.long	.Linfo_string19                 # DW_AT_name
	.byte	4                               # DW_AT_decl_file
	.byte	24                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc14:0xb DW_TAG_typedef
	.long	3103                            # DW_AT_type
	.long	.Linfo_string18                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	38                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xc1f:0x7 DW_TAG_base_type
	.long	.Linfo_string17                 # DW_AT_name
	.byte	8                               # DW_AT_encoding
	.byte	1                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xc26:0xb DW_TAG_typedef
	.long	3121                            # DW_AT_type
	.long	.Linfo_string22                 # DW_AT_name
	.byte	4                               # DW_AT_decl_file
	.byte	25                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc31:0xb DW_TAG_typedef
	.long	3132                            # DW_AT_type
	.long	.Linfo_string21                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	40                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xc3c:0x7 DW_TAG_base_type
	.long	.Linfo_string20                 # DW_AT_name
	.byte	7                               # DW_AT_encoding
	.byte	2                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xc43:0xb DW_TAG_typedef
	.long	3150                            # DW_AT_type
	.long	.Linfo_string25                 # DW_AT_name
	.byte	4                               # DW_AT_decl_file
	.byte	26                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc4e:0xb DW_TAG_typedef
	.long	3161                            # DW_AT_type
	.long	.Linfo_string24                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	42                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xc59:0x7 DW_TAG_base_type
	.long	.Linfo_string23                 # DW_AT_name
	.byte	7                               # DW_AT_encoding
	.byte	4                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xc60:0xb DW_TAG_typedef
	.long	3179                            # DW_AT_type
	.long	.Linfo_string28                 # DW_AT_name
	.byte	4                               # DW_AT_decl_file
	.byte	27                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc6b:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string27                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	45                              # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0xc76:0x7 DW_TAG_base_type
	.long	.Linfo_string26                 # DW_AT_name
	.byte	7                               # DW_AT_encoding
	.byte	8                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0xc7d:0xb DW_TAG_typedef
	.long	3208                            # DW_AT_type
	.long	.Linfo_string30                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	43                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc88:0xb DW_TAG_typedef
	.long	2976                            # DW_AT_type
	.long	.Linfo_string29                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	52                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc93:0xb DW_TAG_typedef
	.long	3230                            # DW_AT_type
	.long	.Linfo_string32                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	44                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xc9e:0xb DW_TAG_typedef
	.long	3005                            # DW_AT_type
	.long	.Linfo_string31                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	54                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xca9:0xb DW_TAG_typedef
	.long	3252                            # DW_AT_type
	.long	.Linfo_string34                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	45                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xcb4:0xb DW_TAG_typedef
	.long	3034                            # DW_AT_type
	.long	.Linfo_string33                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	56                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xcbf:0xb DW_TAG_typedef
	.long	3274                            # DW_AT_type
	.long	.Linfo_string36                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	46                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xcca:0xb DW_TAG_typedef
	.long	3063                            # DW_AT_type
	.long	.Linfo_string35                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	58                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xcd5:0xb DW_TAG_typedef
	.long	3296                            # DW_AT_type
	.long	.Linfo_string38                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	49                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xce0:0xb DW_TAG_typedef
	.long	3092                            # DW_AT_type
	.long	.Linfo_string37                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	53                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xceb:0xb DW_TAG_typedef
	.long	3318                            # DW_AT_type
	.long	.Linfo_string40                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	50                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xcf6:0xb DW_TAG_typedef
	.long	3121                            # DW_AT_type
	.long	.Linfo_string39                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	55                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd01:0xb DW_TAG_typedef
	.long	3340                            # DW_AT_type
	.long	.Linfo_string42                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	51                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd0c:0xb DW_TAG_typedef
	.long	3150                            # DW_AT_type
	.long	.Linfo_string41                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	57                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd17:0xb DW_TAG_typedef
	.long	3362                            # DW_AT_type
	.long	.Linfo_string44                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	52                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd22:0xb DW_TAG_typedef
	.long	3179                            # DW_AT_type
	.long	.Linfo_string43                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	59                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd2d:0xb DW_TAG_typedef
	.long	2987                            # DW_AT_type
	.long	.Linfo_string45                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	58                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd38:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string46                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	60                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd43:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string47                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	61                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd4e:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string48                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	62                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd59:0xb DW_TAG_typedef
	.long	3103                            # DW_AT_type
	.long	.Linfo_string49                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	71                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd64:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string50                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	73                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd6f:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string51                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	74                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd7a:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string52                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	75                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd85:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string53                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	87                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd90:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string54                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	90                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xd9b:0xb DW_TAG_typedef
	.long	3494                            # DW_AT_type
	.long	.Linfo_string56                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	101                             # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xda6:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string55                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	72                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xdb1:0xb DW_TAG_typedef
	.long	3516                            # DW_AT_type
	.long	.Linfo_string58                 # DW_AT_name
	.byte	5                               # DW_AT_decl_file
	.byte	102                             # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0xdbc:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string57                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	73                              # DW_AT_decl_line
	.byte	13                              # Abbrev [13] 0xdc7:0x1b DW_TAG_subprogram
	.long	.Linfo_string59                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	43                              # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xdd2:0x5 DW_TAG_formal_parameter
	.long	3555                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xdd7:0x5 DW_TAG_formal_parameter
	.long	3560                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xddc:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	14                              # Abbrev [14] 0xde2:0x1 DW_TAG_pointer_type
	.byte	15                              # Abbrev [15] 0xde3:0x5 DW_TAG_restrict_type
	.long	3554                            # DW_AT_type
	.byte	15                              # Abbrev [15] 0xde8:0x5 DW_TAG_restrict_type
	.long	3565                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0xded:0x5 DW_TAG_pointer_type
	.long	3570                            # DW_AT_type
	.byte	17                              # Abbrev [17] 0xdf2:0x1 DW_TAG_const_type
	.byte	11                              # Abbrev [11] 0xdf3:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string60                 # DW_AT_name
	.byte	7                               # DW_AT_decl_file
	.byte	18                              # DW_AT_decl_line
	.byte	13                              # Abbrev [13] 0xdfe:0x1b DW_TAG_subprogram
	.long	.Linfo_string61                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	47                              # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xe09:0x5 DW_TAG_formal_parameter
	.long	3554                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe0e:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe13:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xe19:0x16 DW_TAG_subprogram
	.long	.Linfo_string62                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	141                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xe24:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe29:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0xe2f:0x5 DW_TAG_pointer_type
	.long	3636                            # DW_AT_type
	.byte	12                              # Abbrev [12] 0xe34:0x7 DW_TAG_base_type
	.long	.Linfo_string63                 # DW_AT_name
	.byte	6                               # DW_AT_encoding
	.byte	1                               # DW_AT_byte_size
	.byte	15                              # Abbrev [15] 0xe3b:0x5 DW_TAG_restrict_type
	.long	3631                            # DW_AT_type
	.byte	15                              # Abbrev [15] 0xe40:0x5 DW_TAG_restrict_type
	.long	3653                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0xe45:0x5 DW_TAG_pointer_type
	.long	3658                            # DW_AT_type
	.byte	18                              # Abbrev [18] 0xe4a:0x5 DW_TAG_const_type
	.long	3636                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0xe4f:0x1b DW_TAG_subprogram
	.long	.Linfo_string64                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	144                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xe5a:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe5f:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe64:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xe6a:0x16 DW_TAG_subprogram
	.long	.Linfo_string65                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	149                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xe75:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe7a:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xe80:0x1b DW_TAG_subprogram
	.long	.Linfo_string66                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xe8b:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe90:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xe95:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xe9b:0x1b DW_TAG_subprogram
	.long	.Linfo_string67                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	64                              # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xea6:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xeab:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xeb0:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xeb6:0x16 DW_TAG_subprogram
	.long	.Linfo_string68                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	156                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xec1:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xec6:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xecc:0x1b DW_TAG_subprogram
	.long	.Linfo_string69                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xed7:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xedc:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xee1:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xee7:0x16 DW_TAG_subprogram
	.long	.Linfo_string70                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	163                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xef2:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xef7:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xefd:0x1b DW_TAG_subprogram
	.long	.Linfo_string71                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	166                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf08:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf0d:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf12:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xf18:0x1b DW_TAG_subprogram
	.long	.Linfo_string72                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	89                              # DW_AT_decl_line
	.long	3565                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf23:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf28:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf2d:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xf33:0x16 DW_TAG_subprogram
	.long	.Linfo_string73                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	228                             # DW_AT_decl_line
	.long	3653                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf3e:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf43:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xf49:0x17 DW_TAG_subprogram
	.long	.Linfo_string74                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	293                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf55:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf5a:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xf60:0x17 DW_TAG_subprogram
	.long	.Linfo_string75                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	305                             # DW_AT_decl_line
	.long	3653                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf6c:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf71:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xf77:0x16 DW_TAG_subprogram
	.long	.Linfo_string76                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	255                             # DW_AT_decl_line
	.long	3653                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf82:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf87:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xf8d:0x17 DW_TAG_subprogram
	.long	.Linfo_string77                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	297                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xf99:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xf9e:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xfa4:0x17 DW_TAG_subprogram
	.long	.Linfo_string78                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	332                             # DW_AT_decl_line
	.long	3653                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xfb0:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xfb5:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xfbb:0x17 DW_TAG_subprogram
	.long	.Linfo_string79                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	356                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xfc7:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xfcc:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0xfd2:0x1b DW_TAG_subprogram
	.long	.Linfo_string80                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.byte	61                              # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xfdd:0x5 DW_TAG_formal_parameter
	.long	3554                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xfe2:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0xfe7:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xfed:0x12 DW_TAG_subprogram
	.long	.Linfo_string81                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	419                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0xff9:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0xfff:0x12 DW_TAG_subprogram
	.long	.Linfo_string82                 # DW_AT_name
	.byte	6                               # DW_AT_decl_file
	.short	407                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x100b:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x1011:0xb DW_TAG_typedef
	.long	4124                            # DW_AT_type
	.long	.Linfo_string87                 # DW_AT_name
	.byte	10                              # DW_AT_decl_file
	.byte	7                               # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0x101c:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string86                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	156                             # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0x1027:0xb DW_TAG_typedef
	.long	4146                            # DW_AT_type
	.long	.Linfo_string89                 # DW_AT_name
	.byte	12                              # DW_AT_decl_file
	.byte	10                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0x1032:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string88                 # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	160                             # DW_AT_decl_line
	.byte	20                              # Abbrev [20] 0x103d:0x8e DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.long	.Linfo_string101                # DW_AT_name
	.byte	56                              # DW_AT_byte_size
	.byte	13                              # DW_AT_decl_file
	.byte	7                               # DW_AT_decl_line
	.byte	21                              # Abbrev [21] 0x1046:0xc DW_TAG_member
	.long	.Linfo_string90                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	9                               # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1052:0xc DW_TAG_member
	.long	.Linfo_string91                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	10                              # DW_AT_decl_line
	.byte	4                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x105e:0xc DW_TAG_member
	.long	.Linfo_string92                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	11                              # DW_AT_decl_line
	.byte	8                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x106a:0xc DW_TAG_member
	.long	.Linfo_string93                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	12                              # DW_AT_decl_line
	.byte	12                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1076:0xc DW_TAG_member
	.long	.Linfo_string94                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	13                              # DW_AT_decl_line
	.byte	16                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1082:0xc DW_TAG_member
	.long	.Linfo_string95                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	14                              # DW_AT_decl_line
	.byte	20                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x108e:0xc DW_TAG_member
	.long	.Linfo_string96                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	15                              # DW_AT_decl_line
	.byte	24                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x109a:0xc DW_TAG_member
	.long	.Linfo_string97                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	16                              # DW_AT_decl_line
	.byte	28                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x10a6:0xc DW_TAG_member
	.long	.Linfo_string98                 # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	17                              # DW_AT_decl_line
	.byte	32                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x10b2:0xc DW_TAG_member
	.long	.Linfo_string99                 # DW_AT_name
	.long	3074                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	20                              # DW_AT_decl_line
	.byte	40                              # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x10be:0xc DW_TAG_member
	.long	.Linfo_string100                # DW_AT_name
	.long	3653                            # DW_AT_type
	.byte	13                              # DW_AT_decl_file
	.byte	21                              # DW_AT_decl_line
	.byte	48                              # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	20                              # Abbrev [20] 0x10cb:0x22 DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.long	.Linfo_string105                # DW_AT_name
	.byte	16                              # DW_AT_byte_size
	.byte	14                              # DW_AT_decl_file
	.byte	11                              # DW_AT_decl_line
	.byte	21                              # Abbrev [21] 0x10d4:0xc DW_TAG_member
	.long	.Linfo_string102                # DW_AT_name
	.long	4146                            # DW_AT_type
	.byte	14                              # DW_AT_decl_file
	.byte	16                              # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x10e0:0xc DW_TAG_member
	.long	.Linfo_string103                # DW_AT_name
	.long	4333                            # DW_AT_type
	.byte	14                              # DW_AT_decl_file
	.byte	21                              # DW_AT_decl_line
	.byte	8                               # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x10ed:0xb DW_TAG_typedef
	.long	3074                            # DW_AT_type
	.long	.Linfo_string104                # DW_AT_name
	.byte	1                               # DW_AT_decl_file
	.byte	197                             # DW_AT_decl_line
	.byte	22                              # Abbrev [22] 0x10f8:0xb DW_TAG_subprogram
	.long	.Linfo_string106                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	72                              # DW_AT_decl_line
	.long	4113                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	13                              # Abbrev [13] 0x1103:0x16 DW_TAG_subprogram
	.long	.Linfo_string107                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	79                              # DW_AT_decl_line
	.long	4377                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x110e:0x5 DW_TAG_formal_parameter
	.long	4135                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1113:0x5 DW_TAG_formal_parameter
	.long	4135                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	12                              # Abbrev [12] 0x1119:0x7 DW_TAG_base_type
	.long	.Linfo_string108                # DW_AT_name
	.byte	4                               # DW_AT_encoding
	.byte	8                               # DW_AT_byte_size
	.byte	13                              # Abbrev [13] 0x1120:0x11 DW_TAG_subprogram
	.long	.Linfo_string109                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	83                              # DW_AT_decl_line
	.long	4135                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x112b:0x5 DW_TAG_formal_parameter
	.long	4401                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x1131:0x5 DW_TAG_pointer_type
	.long	4157                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x1136:0x11 DW_TAG_subprogram
	.long	.Linfo_string110                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	76                              # DW_AT_decl_line
	.long	4135                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1141:0x5 DW_TAG_formal_parameter
	.long	4423                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x1147:0x5 DW_TAG_pointer_type
	.long	4135                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x114c:0x11 DW_TAG_subprogram
	.long	.Linfo_string111                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	179                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1157:0x5 DW_TAG_formal_parameter
	.long	4445                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x115d:0x5 DW_TAG_pointer_type
	.long	4450                            # DW_AT_type
	.byte	18                              # Abbrev [18] 0x1162:0x5 DW_TAG_const_type
	.long	4157                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x1167:0x11 DW_TAG_subprogram
	.long	.Linfo_string112                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	183                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1172:0x5 DW_TAG_formal_parameter
	.long	4472                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x1178:0x5 DW_TAG_pointer_type
	.long	4477                            # DW_AT_type
	.byte	18                              # Abbrev [18] 0x117d:0x5 DW_TAG_const_type
	.long	4135                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x1182:0x11 DW_TAG_subprogram
	.long	.Linfo_string113                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	132                             # DW_AT_decl_line
	.long	4401                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x118d:0x5 DW_TAG_formal_parameter
	.long	4472                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1193:0x11 DW_TAG_subprogram
	.long	.Linfo_string114                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	136                             # DW_AT_decl_line
	.long	4401                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x119e:0x5 DW_TAG_formal_parameter
	.long	4472                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x11a4:0x20 DW_TAG_subprogram
	.long	.Linfo_string115                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.byte	100                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x11af:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x11b4:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x11b9:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x11be:0x5 DW_TAG_formal_parameter
	.long	4548                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x11c4:0x5 DW_TAG_restrict_type
	.long	4445                            # DW_AT_type
	.byte	19                              # Abbrev [19] 0x11c9:0x17 DW_TAG_subprogram
	.long	.Linfo_string116                # DW_AT_name
	.byte	15                              # DW_AT_decl_file
	.short	383                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x11d5:0x5 DW_TAG_formal_parameter
	.long	4576                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x11da:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x11e0:0x5 DW_TAG_pointer_type
	.long	4299                            # DW_AT_type
	.byte	12                              # Abbrev [12] 0x11e5:0x7 DW_TAG_base_type
	.long	.Linfo_string120                # DW_AT_name
	.byte	2                               # DW_AT_encoding
	.byte	1                               # DW_AT_byte_size
	.byte	12                              # Abbrev [12] 0x11ec:0x7 DW_TAG_base_type
	.long	.Linfo_string121                # DW_AT_name
	.byte	4                               # DW_AT_encoding
	.byte	16                              # DW_AT_byte_size
	.byte	10                              # Abbrev [10] 0x11f3:0x8 DW_TAG_imported_declaration
	.byte	17                              # DW_AT_decl_file
	.short	420                             # DW_AT_decl_line
	.long	525                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x11fb:0x8 DW_TAG_imported_declaration
	.byte	17                              # DW_AT_decl_file
	.short	423                             # DW_AT_decl_line
	.long	546                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x1203:0x8 DW_TAG_imported_declaration
	.byte	17                              # DW_AT_decl_file
	.short	427                             # DW_AT_decl_line
	.long	567                             # DW_AT_import
	.byte	10                              # Abbrev [10] 0x120b:0x8 DW_TAG_imported_declaration
	.byte	17                              # DW_AT_decl_file
	.short	428                             # DW_AT_decl_line
	.long	588                             # DW_AT_import
	.byte	16                              # Abbrev [16] 0x1213:0x5 DW_TAG_pointer_type
	.long	4588                            # DW_AT_type
	.byte	10                              # Abbrev [10] 0x1218:0x8 DW_TAG_imported_declaration
	.byte	17                              # DW_AT_decl_file
	.short	495                             # DW_AT_decl_line
	.long	609                             # DW_AT_import
	.byte	11                              # Abbrev [11] 0x1220:0xb DW_TAG_typedef
	.long	4651                            # DW_AT_type
	.long	.Linfo_string131                # DW_AT_name
	.byte	20                              # DW_AT_decl_file
	.byte	163                             # DW_AT_decl_line
	.byte	12                              # Abbrev [12] 0x122b:0x7 DW_TAG_base_type
	.long	.Linfo_string130                # DW_AT_name
	.byte	4                               # DW_AT_encoding
	.byte	4                               # DW_AT_byte_size
	.byte	11                              # Abbrev [11] 0x1232:0xb DW_TAG_typedef
	.long	4377                            # DW_AT_type
	.long	.Linfo_string132                # DW_AT_name
	.byte	20                              # DW_AT_decl_file
	.byte	164                             # DW_AT_decl_line
	.byte	13                              # Abbrev [13] 0x123d:0x11 DW_TAG_subprogram
	.long	.Linfo_string133                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	53                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1248:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x124e:0x11 DW_TAG_subprogram
	.long	.Linfo_string134                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	55                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1259:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x125f:0x11 DW_TAG_subprogram
	.long	.Linfo_string135                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	57                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x126a:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1270:0x16 DW_TAG_subprogram
	.long	.Linfo_string136                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	59                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x127b:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1280:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1286:0x11 DW_TAG_subprogram
	.long	.Linfo_string137                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1291:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1297:0x11 DW_TAG_subprogram
	.long	.Linfo_string138                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	62                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x12a2:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x12a8:0x11 DW_TAG_subprogram
	.long	.Linfo_string139                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	71                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x12b3:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x12b9:0x11 DW_TAG_subprogram
	.long	.Linfo_string140                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	95                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x12c4:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x12ca:0x11 DW_TAG_subprogram
	.long	.Linfo_string141                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	162                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x12d5:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x12db:0x11 DW_TAG_subprogram
	.long	.Linfo_string142                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	165                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x12e6:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x12ec:0x16 DW_TAG_subprogram
	.long	.Linfo_string143                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	168                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x12f7:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x12fc:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1302:0x16 DW_TAG_subprogram
	.long	.Linfo_string144                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	98                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x130d:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1312:0x5 DW_TAG_formal_parameter
	.long	4888                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x1318:0x5 DW_TAG_pointer_type
	.long	3045                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x131d:0x16 DW_TAG_subprogram
	.long	.Linfo_string145                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	101                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1328:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x132d:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1333:0x11 DW_TAG_subprogram
	.long	.Linfo_string146                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	104                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x133e:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1344:0x11 DW_TAG_subprogram
	.long	.Linfo_string147                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	107                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x134f:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1355:0x16 DW_TAG_subprogram
	.long	.Linfo_string148                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	110                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1360:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1365:0x5 DW_TAG_formal_parameter
	.long	4971                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x136b:0x5 DW_TAG_pointer_type
	.long	4651                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x1370:0x16 DW_TAG_subprogram
	.long	.Linfo_string149                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	140                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x137b:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1380:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1386:0x11 DW_TAG_subprogram
	.long	.Linfo_string150                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	64                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1391:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1397:0x11 DW_TAG_subprogram
	.long	.Linfo_string151                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	73                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x13a2:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x13a8:0x11 DW_TAG_subprogram
	.long	.Linfo_string152                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	143                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x13b3:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x13b9:0x11 DW_TAG_subprogram
	.long	.Linfo_string153                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	66                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x13c4:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x13ca:0x11 DW_TAG_subprogram
	.long	.Linfo_string154                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	75                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x13d5:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x13db:0x11 DW_TAG_subprogram
	.long	.Linfo_string155                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	85                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x13e6:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x13ec:0x11 DW_TAG_subprogram
	.long	.Linfo_string156                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	87                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x13f7:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x13fd:0x11 DW_TAG_subprogram
	.long	.Linfo_string157                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	89                              # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1408:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x140e:0x11 DW_TAG_subprogram
	.long	.Linfo_string158                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1419:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x141f:0x16 DW_TAG_subprogram
	.long	.Linfo_string159                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	198                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x142a:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x142f:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1435:0x11 DW_TAG_subprogram
	.long	.Linfo_string160                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	231                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1440:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1446:0x11 DW_TAG_subprogram
	.long	.Linfo_string161                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	232                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1451:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1457:0x11 DW_TAG_subprogram
	.long	.Linfo_string162                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	130                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1462:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1468:0x11 DW_TAG_subprogram
	.long	.Linfo_string163                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	119                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1473:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1479:0x17 DW_TAG_subprogram
	.long	.Linfo_string164                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	329                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1485:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x148a:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1490:0x1c DW_TAG_subprogram
	.long	.Linfo_string165                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	340                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x149c:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x14a1:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x14a6:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x14ac:0x17 DW_TAG_subprogram
	.long	.Linfo_string166                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	333                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x14b8:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x14bd:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x14c3:0x17 DW_TAG_subprogram
	.long	.Linfo_string167                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	336                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x14cf:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x14d4:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x14da:0x16 DW_TAG_subprogram
	.long	.Linfo_string168                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	147                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x14e5:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x14ea:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x14f0:0x12 DW_TAG_subprogram
	.long	.Linfo_string169                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	283                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x14fc:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1502:0x11 DW_TAG_subprogram
	.long	.Linfo_string170                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	233                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x150d:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1513:0x12 DW_TAG_subprogram
	.long	.Linfo_string171                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	319                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x151f:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	12                              # Abbrev [12] 0x1525:0x7 DW_TAG_base_type
	.long	.Linfo_string172                # DW_AT_name
	.byte	5                               # DW_AT_encoding
	.byte	8                               # DW_AT_byte_size
	.byte	19                              # Abbrev [19] 0x152c:0x12 DW_TAG_subprogram
	.long	.Linfo_string173                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	325                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1538:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x153e:0x11 DW_TAG_subprogram
	.long	.Linfo_string174                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	122                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1549:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x154f:0x11 DW_TAG_subprogram
	.long	.Linfo_string175                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	133                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x155a:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1560:0x11 DW_TAG_subprogram
	.long	.Linfo_string176                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x156b:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1571:0x12 DW_TAG_subprogram
	.long	.Linfo_string177                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	317                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x157d:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1583:0x12 DW_TAG_subprogram
	.long	.Linfo_string178                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	323                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x158f:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1595:0x11 DW_TAG_subprogram
	.long	.Linfo_string179                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	203                             # DW_AT_decl_line
	.long	4377                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x15a0:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x15a6:0x11 DW_TAG_subprogram
	.long	.Linfo_string180                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	203                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x15b1:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x15b7:0x12 DW_TAG_subprogram
	.long	.Linfo_string181                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	297                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x15c3:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x15c9:0x17 DW_TAG_subprogram
	.long	.Linfo_string182                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	262                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x15d5:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x15da:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x15e0:0x17 DW_TAG_subprogram
	.long	.Linfo_string183                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	264                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x15ec:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x15f1:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x15f7:0x17 DW_TAG_subprogram
	.long	.Linfo_string184                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	275                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1603:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1608:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x160e:0x1c DW_TAG_subprogram
	.long	.Linfo_string185                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	310                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x161a:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x161f:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1624:0x5 DW_TAG_formal_parameter
	.long	4888                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x162a:0x12 DW_TAG_subprogram
	.long	.Linfo_string186                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	259                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1636:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x163c:0x12 DW_TAG_subprogram
	.long	.Linfo_string187                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	301                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1648:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x164e:0x17 DW_TAG_subprogram
	.long	.Linfo_string188                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	293                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x165a:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x165f:0x5 DW_TAG_formal_parameter
	.long	3074                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1665:0x17 DW_TAG_subprogram
	.long	.Linfo_string189                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	279                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1671:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1676:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x167c:0x11 DW_TAG_subprogram
	.long	.Linfo_string190                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	238                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1687:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x168d:0x12 DW_TAG_subprogram
	.long	.Linfo_string191                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	305                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1699:0x5 DW_TAG_formal_parameter
	.long	4651                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x169f:0x11 DW_TAG_subprogram
	.long	.Linfo_string192                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	53                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x16aa:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x16b0:0x11 DW_TAG_subprogram
	.long	.Linfo_string193                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	55                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x16bb:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x16c1:0x11 DW_TAG_subprogram
	.long	.Linfo_string194                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	57                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x16cc:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x16d2:0x16 DW_TAG_subprogram
	.long	.Linfo_string195                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	59                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x16dd:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x16e2:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x16e8:0x11 DW_TAG_subprogram
	.long	.Linfo_string196                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x16f3:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x16f9:0x11 DW_TAG_subprogram
	.long	.Linfo_string197                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	62                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1704:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x170a:0x11 DW_TAG_subprogram
	.long	.Linfo_string198                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	71                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1715:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x171b:0x11 DW_TAG_subprogram
	.long	.Linfo_string199                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	95                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1726:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x172c:0x11 DW_TAG_subprogram
	.long	.Linfo_string200                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	162                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1737:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x173d:0x11 DW_TAG_subprogram
	.long	.Linfo_string201                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	165                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1748:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x174e:0x16 DW_TAG_subprogram
	.long	.Linfo_string202                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	168                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1759:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x175e:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1764:0x16 DW_TAG_subprogram
	.long	.Linfo_string203                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	98                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x176f:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1774:0x5 DW_TAG_formal_parameter
	.long	4888                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x177a:0x16 DW_TAG_subprogram
	.long	.Linfo_string204                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	101                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1785:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x178a:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1790:0x11 DW_TAG_subprogram
	.long	.Linfo_string205                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	104                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x179b:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x17a1:0x11 DW_TAG_subprogram
	.long	.Linfo_string206                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	107                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x17ac:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x17b2:0x16 DW_TAG_subprogram
	.long	.Linfo_string207                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	110                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x17bd:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x17c2:0x5 DW_TAG_formal_parameter
	.long	4627                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x17c8:0x16 DW_TAG_subprogram
	.long	.Linfo_string208                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	140                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x17d3:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x17d8:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x17de:0x11 DW_TAG_subprogram
	.long	.Linfo_string209                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	64                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x17e9:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x17ef:0x11 DW_TAG_subprogram
	.long	.Linfo_string210                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	73                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x17fa:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1800:0x11 DW_TAG_subprogram
	.long	.Linfo_string211                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	143                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x180b:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1811:0x11 DW_TAG_subprogram
	.long	.Linfo_string212                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	66                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x181c:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1822:0x11 DW_TAG_subprogram
	.long	.Linfo_string213                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	75                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x182d:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1833:0x11 DW_TAG_subprogram
	.long	.Linfo_string214                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	85                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x183e:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1844:0x11 DW_TAG_subprogram
	.long	.Linfo_string215                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	87                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x184f:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1855:0x11 DW_TAG_subprogram
	.long	.Linfo_string216                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	89                              # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1860:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1866:0x11 DW_TAG_subprogram
	.long	.Linfo_string217                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1871:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1877:0x16 DW_TAG_subprogram
	.long	.Linfo_string218                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	198                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1882:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1887:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x188d:0x11 DW_TAG_subprogram
	.long	.Linfo_string219                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	231                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1898:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x189e:0x11 DW_TAG_subprogram
	.long	.Linfo_string220                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	232                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x18a9:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x18af:0x11 DW_TAG_subprogram
	.long	.Linfo_string221                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	130                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x18ba:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x18c0:0x11 DW_TAG_subprogram
	.long	.Linfo_string222                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	119                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x18cb:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x18d1:0x17 DW_TAG_subprogram
	.long	.Linfo_string223                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	329                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x18dd:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x18e2:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x18e8:0x1c DW_TAG_subprogram
	.long	.Linfo_string224                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	340                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x18f4:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x18f9:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x18fe:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1904:0x17 DW_TAG_subprogram
	.long	.Linfo_string225                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	333                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1910:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1915:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x191b:0x17 DW_TAG_subprogram
	.long	.Linfo_string226                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	336                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1927:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x192c:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1932:0x16 DW_TAG_subprogram
	.long	.Linfo_string227                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	147                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x193d:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1942:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1948:0x12 DW_TAG_subprogram
	.long	.Linfo_string228                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	283                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1954:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x195a:0x11 DW_TAG_subprogram
	.long	.Linfo_string229                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	233                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1965:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x196b:0x12 DW_TAG_subprogram
	.long	.Linfo_string230                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	319                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1977:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x197d:0x12 DW_TAG_subprogram
	.long	.Linfo_string231                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	325                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1989:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x198f:0x11 DW_TAG_subprogram
	.long	.Linfo_string232                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	122                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x199a:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x19a0:0x11 DW_TAG_subprogram
	.long	.Linfo_string233                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	133                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x19ab:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x19b1:0x11 DW_TAG_subprogram
	.long	.Linfo_string234                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x19bc:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x19c2:0x12 DW_TAG_subprogram
	.long	.Linfo_string235                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	317                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x19ce:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x19d4:0x12 DW_TAG_subprogram
	.long	.Linfo_string236                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	323                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x19e0:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x19e6:0x11 DW_TAG_subprogram
	.long	.Linfo_string237                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	203                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x19f1:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x19f7:0x12 DW_TAG_subprogram
	.long	.Linfo_string238                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	297                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a03:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a09:0x17 DW_TAG_subprogram
	.long	.Linfo_string239                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	262                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a15:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1a1a:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a20:0x17 DW_TAG_subprogram
	.long	.Linfo_string240                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	264                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a2c:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1a31:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a37:0x17 DW_TAG_subprogram
	.long	.Linfo_string241                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	275                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a43:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1a48:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a4e:0x1c DW_TAG_subprogram
	.long	.Linfo_string242                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	310                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a5a:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1a5f:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1a64:0x5 DW_TAG_formal_parameter
	.long	4888                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a6a:0x12 DW_TAG_subprogram
	.long	.Linfo_string243                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	259                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a76:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a7c:0x12 DW_TAG_subprogram
	.long	.Linfo_string244                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	301                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a88:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1a8e:0x17 DW_TAG_subprogram
	.long	.Linfo_string245                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	293                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1a9a:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1a9f:0x5 DW_TAG_formal_parameter
	.long	3074                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1aa5:0x17 DW_TAG_subprogram
	.long	.Linfo_string246                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	279                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ab1:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1ab6:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1abc:0x11 DW_TAG_subprogram
	.long	.Linfo_string247                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.byte	238                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ac7:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1acd:0x12 DW_TAG_subprogram
	.long	.Linfo_string248                # DW_AT_name
	.byte	21                              # DW_AT_decl_file
	.short	305                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ad9:0x5 DW_TAG_formal_parameter
	.long	4588                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x1adf:0xb DW_TAG_typedef
	.long	6890                            # DW_AT_type
	.long	.Linfo_string251                # DW_AT_name
	.byte	22                              # DW_AT_decl_file
	.byte	24                              # DW_AT_decl_line
	.byte	23                              # Abbrev [23] 0x1aea:0x20 DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.byte	32                              # DW_AT_byte_size
	.byte	22                              # DW_AT_decl_file
	.byte	19                              # DW_AT_decl_line
	.byte	24                              # Abbrev [24] 0x1aef:0xd DW_TAG_member
	.long	.Linfo_string249                # DW_AT_name
	.long	5413                            # DW_AT_type
	.byte	22                              # DW_AT_decl_file
	.byte	20                              # DW_AT_decl_line
	.byte	8                               # DW_AT_alignment
	.byte	0                               # DW_AT_data_member_location
	.byte	24                              # Abbrev [24] 0x1afc:0xd DW_TAG_member
	.long	.Linfo_string250                # DW_AT_name
	.long	4588                            # DW_AT_type
	.byte	22                              # DW_AT_decl_file
	.byte	22                              # DW_AT_decl_line
	.byte	16                              # DW_AT_alignment
	.byte	16                              # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x1b0a:0xb DW_TAG_typedef
	.long	6933                            # DW_AT_type
	.long	.Linfo_string252                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	63                              # DW_AT_decl_line
	.byte	25                              # Abbrev [25] 0x1b15:0x1 DW_TAG_structure_type
                                        # DW_AT_declaration
	.byte	11                              # Abbrev [11] 0x1b16:0xb DW_TAG_typedef
	.long	6945                            # DW_AT_type
	.long	.Linfo_string255                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	71                              # DW_AT_decl_line
	.byte	23                              # Abbrev [23] 0x1b21:0x1e DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.byte	16                              # DW_AT_byte_size
	.byte	24                              # DW_AT_decl_file
	.byte	67                              # DW_AT_decl_line
	.byte	21                              # Abbrev [21] 0x1b26:0xc DW_TAG_member
	.long	.Linfo_string253                # DW_AT_name
	.long	3074                            # DW_AT_type
	.byte	24                              # DW_AT_decl_file
	.byte	69                              # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1b32:0xc DW_TAG_member
	.long	.Linfo_string254                # DW_AT_name
	.long	3074                            # DW_AT_type
	.byte	24                              # DW_AT_decl_file
	.byte	70                              # DW_AT_decl_line
	.byte	8                               # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x1b3f:0xb DW_TAG_typedef
	.long	6986                            # DW_AT_type
	.long	.Linfo_string256                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	81                              # DW_AT_decl_line
	.byte	23                              # Abbrev [23] 0x1b4a:0x1e DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.byte	16                              # DW_AT_byte_size
	.byte	24                              # DW_AT_decl_file
	.byte	77                              # DW_AT_decl_line
	.byte	21                              # Abbrev [21] 0x1b4f:0xc DW_TAG_member
	.long	.Linfo_string253                # DW_AT_name
	.long	5413                            # DW_AT_type
	.byte	24                              # DW_AT_decl_file
	.byte	79                              # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1b5b:0xc DW_TAG_member
	.long	.Linfo_string254                # DW_AT_name
	.long	5413                            # DW_AT_type
	.byte	24                              # DW_AT_decl_file
	.byte	80                              # DW_AT_decl_line
	.byte	8                               # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1b68:0x11 DW_TAG_subprogram
	.long	.Linfo_string257                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	102                             # DW_AT_decl_line
	.long	4377                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1b73:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1b79:0x11 DW_TAG_subprogram
	.long	.Linfo_string258                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	105                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1b84:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1b8a:0x11 DW_TAG_subprogram
	.long	.Linfo_string259                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	108                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1b95:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1b9b:0x11 DW_TAG_subprogram
	.long	.Linfo_string260                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	113                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ba6:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1bac:0x16 DW_TAG_subprogram
	.long	.Linfo_string261                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	118                             # DW_AT_decl_line
	.long	4377                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1bb7:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1bbc:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x1bc2:0x5 DW_TAG_restrict_type
	.long	7111                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0x1bc7:0x5 DW_TAG_pointer_type
	.long	3631                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x1bcc:0x16 DW_TAG_subprogram
	.long	.Linfo_string262                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	124                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1bd7:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1bdc:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1be2:0x16 DW_TAG_subprogram
	.long	.Linfo_string263                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	127                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1bed:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1bf2:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1bf8:0x1b DW_TAG_subprogram
	.long	.Linfo_string264                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	177                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1c03:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c08:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c0d:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1c13:0x1b DW_TAG_subprogram
	.long	.Linfo_string265                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	201                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1c1e:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c23:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c28:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1c2e:0x1b DW_TAG_subprogram
	.long	.Linfo_string266                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	181                             # DW_AT_decl_line
	.long	3190                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1c39:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c3e:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c43:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1c49:0x1b DW_TAG_subprogram
	.long	.Linfo_string267                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.byte	206                             # DW_AT_decl_line
	.long	7268                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1c54:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c59:0x5 DW_TAG_formal_parameter
	.long	7106                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c5e:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	12                              # Abbrev [12] 0x1c64:0x7 DW_TAG_base_type
	.long	.Linfo_string268                # DW_AT_name
	.byte	7                               # DW_AT_encoding
	.byte	8                               # DW_AT_byte_size
	.byte	26                              # Abbrev [26] 0x1c6b:0xc DW_TAG_subprogram
	.long	.Linfo_string269                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	454                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	27                              # Abbrev [27] 0x1c77:0xe DW_TAG_subprogram
	.long	.Linfo_string270                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	456                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1c7f:0x5 DW_TAG_formal_parameter
	.long	3161                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1c85:0x17 DW_TAG_subprogram
	.long	.Linfo_string271                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	556                             # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1c91:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1c96:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	27                              # Abbrev [27] 0x1c9c:0xe DW_TAG_subprogram
	.long	.Linfo_string272                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	568                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ca4:0x5 DW_TAG_formal_parameter
	.long	3554                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1caa:0x12 DW_TAG_subprogram
	.long	.Linfo_string273                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	553                             # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1cb6:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1cbc:0x17 DW_TAG_subprogram
	.long	.Linfo_string274                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	564                             # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1cc8:0x5 DW_TAG_formal_parameter
	.long	3554                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1ccd:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	28                              # Abbrev [28] 0x1cd3:0x8 DW_TAG_subprogram
	.long	.Linfo_string275                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	611                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
                                        # DW_AT_noreturn
	.byte	19                              # Abbrev [19] 0x1cdb:0x12 DW_TAG_subprogram
	.long	.Linfo_string276                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	615                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ce7:0x5 DW_TAG_formal_parameter
	.long	7405                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x1ced:0x5 DW_TAG_pointer_type
	.long	7410                            # DW_AT_type
	.byte	29                              # Abbrev [29] 0x1cf2:0x1 DW_TAG_subroutine_type
	.byte	30                              # Abbrev [30] 0x1cf3:0xe DW_TAG_subprogram
	.long	.Linfo_string277                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	637                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
                                        # DW_AT_noreturn
	.byte	9                               # Abbrev [9] 0x1cfb:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	30                              # Abbrev [30] 0x1d01:0xe DW_TAG_subprogram
	.long	.Linfo_string278                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	649                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
                                        # DW_AT_noreturn
	.byte	9                               # Abbrev [9] 0x1d09:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1d0f:0x12 DW_TAG_subprogram
	.long	.Linfo_string279                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	654                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1d1b:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1d21:0x12 DW_TAG_subprogram
	.long	.Linfo_string280                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	804                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1d2d:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1d33:0x26 DW_TAG_subprogram
	.long	.Linfo_string281                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	841                             # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1d3f:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d44:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d49:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d4e:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d53:0x5 DW_TAG_formal_parameter
	.long	7513                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	31                              # Abbrev [31] 0x1d59:0xc DW_TAG_typedef
	.long	7525                            # DW_AT_type
	.long	.Linfo_string282                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	829                             # DW_AT_decl_line
	.byte	16                              # Abbrev [16] 0x1d65:0x5 DW_TAG_pointer_type
	.long	7530                            # DW_AT_type
	.byte	32                              # Abbrev [32] 0x1d6a:0x10 DW_TAG_subroutine_type
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d6f:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d74:0x5 DW_TAG_formal_parameter
	.long	3565                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	27                              # Abbrev [27] 0x1d7a:0x1d DW_TAG_subprogram
	.long	.Linfo_string283                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	851                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1d82:0x5 DW_TAG_formal_parameter
	.long	3554                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d87:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d8c:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1d91:0x5 DW_TAG_formal_parameter
	.long	7513                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1d97:0x12 DW_TAG_subprogram
	.long	.Linfo_string284                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	861                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1da3:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1da9:0x12 DW_TAG_subprogram
	.long	.Linfo_string285                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	862                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1db5:0x5 DW_TAG_formal_parameter
	.long	3074                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1dbb:0x12 DW_TAG_subprogram
	.long	.Linfo_string286                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	865                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1dc7:0x5 DW_TAG_formal_parameter
	.long	5413                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	8                               # Abbrev [8] 0x1dcd:0x1a DW_TAG_subprogram
	.long	.Linfo_string287                # DW_AT_linkage_name
	.long	.Linfo_string288                # DW_AT_name
	.byte	26                              # DW_AT_decl_file
	.byte	128                             # DW_AT_decl_line
	.long	6975                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ddc:0x5 DW_TAG_formal_parameter
	.long	5413                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1de1:0x5 DW_TAG_formal_parameter
	.long	5413                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1de7:0x17 DW_TAG_subprogram
	.long	.Linfo_string289                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	875                             # DW_AT_decl_line
	.long	6934                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1df3:0x5 DW_TAG_formal_parameter
	.long	3074                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1df8:0x5 DW_TAG_formal_parameter
	.long	3074                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1dfe:0x17 DW_TAG_subprogram
	.long	.Linfo_string290                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	879                             # DW_AT_decl_line
	.long	6975                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1e0a:0x5 DW_TAG_formal_parameter
	.long	5413                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e0f:0x5 DW_TAG_formal_parameter
	.long	5413                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1e15:0x17 DW_TAG_subprogram
	.long	.Linfo_string291                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	943                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1e21:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e26:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1e2c:0x1c DW_TAG_subprogram
	.long	.Linfo_string292                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	946                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1e38:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e3d:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e42:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x1e48:0x5 DW_TAG_restrict_type
	.long	7757                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0x1e4d:0x5 DW_TAG_pointer_type
	.long	7762                            # DW_AT_type
	.byte	12                              # Abbrev [12] 0x1e52:0x7 DW_TAG_base_type
	.long	.Linfo_string293                # DW_AT_name
	.byte	5                               # DW_AT_encoding
	.byte	4                               # DW_AT_byte_size
	.byte	19                              # Abbrev [19] 0x1e59:0x17 DW_TAG_subprogram
	.long	.Linfo_string294                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	950                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1e65:0x5 DW_TAG_formal_parameter
	.long	3631                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e6a:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1e70:0x1c DW_TAG_subprogram
	.long	.Linfo_string295                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	954                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1e7c:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e81:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e86:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1e8c:0x1c DW_TAG_subprogram
	.long	.Linfo_string296                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	958                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1e98:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1e9d:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1ea2:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x1ea8:0x5 DW_TAG_restrict_type
	.long	7853                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0x1ead:0x5 DW_TAG_pointer_type
	.long	7858                            # DW_AT_type
	.byte	18                              # Abbrev [18] 0x1eb2:0x5 DW_TAG_const_type
	.long	7762                            # DW_AT_type
	.byte	19                              # Abbrev [19] 0x1eb7:0x12 DW_TAG_subprogram
	.long	.Linfo_string297                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	620                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ec3:0x5 DW_TAG_formal_parameter
	.long	7405                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	30                              # Abbrev [30] 0x1ec9:0xe DW_TAG_subprogram
	.long	.Linfo_string298                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	643                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
                                        # DW_AT_noreturn
	.byte	9                               # Abbrev [9] 0x1ed1:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x1ed7:0x17 DW_TAG_subprogram
	.long	.Linfo_string299                # DW_AT_name
	.byte	24                              # DW_AT_decl_file
	.short	605                             # DW_AT_decl_line
	.long	3554                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ee3:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x1ee8:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x1eee:0xb DW_TAG_typedef
	.long	7929                            # DW_AT_type
	.long	.Linfo_string306                # DW_AT_name
	.byte	28                              # DW_AT_decl_file
	.byte	6                               # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0x1ef9:0xb DW_TAG_typedef
	.long	7940                            # DW_AT_type
	.long	.Linfo_string305                # DW_AT_name
	.byte	27                              # DW_AT_decl_file
	.byte	21                              # DW_AT_decl_line
	.byte	23                              # Abbrev [23] 0x1f04:0x3c DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.byte	8                               # DW_AT_byte_size
	.byte	27                              # DW_AT_decl_file
	.byte	13                              # DW_AT_decl_line
	.byte	21                              # Abbrev [21] 0x1f09:0xc DW_TAG_member
	.long	.Linfo_string300                # DW_AT_name
	.long	3045                            # DW_AT_type
	.byte	27                              # DW_AT_decl_file
	.byte	15                              # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1f15:0xc DW_TAG_member
	.long	.Linfo_string301                # DW_AT_name
	.long	7969                            # DW_AT_type
	.byte	27                              # DW_AT_decl_file
	.byte	20                              # DW_AT_decl_line
	.byte	4                               # DW_AT_data_member_location
	.byte	33                              # Abbrev [33] 0x1f21:0x1e DW_TAG_union_type
	.byte	5                               # DW_AT_calling_convention
	.byte	4                               # DW_AT_byte_size
	.byte	27                              # DW_AT_decl_file
	.byte	16                              # DW_AT_decl_line
	.byte	21                              # Abbrev [21] 0x1f26:0xc DW_TAG_member
	.long	.Linfo_string302                # DW_AT_name
	.long	3161                            # DW_AT_type
	.byte	27                              # DW_AT_decl_file
	.byte	18                              # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	21                              # Abbrev [21] 0x1f32:0xc DW_TAG_member
	.long	.Linfo_string303                # DW_AT_name
	.long	8000                            # DW_AT_type
	.byte	27                              # DW_AT_decl_file
	.byte	19                              # DW_AT_decl_line
	.byte	0                               # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	0                               # End Of Children Mark
	.byte	34                              # Abbrev [34] 0x1f40:0xc DW_TAG_array_type
	.long	3636                            # DW_AT_type
	.byte	35                              # Abbrev [35] 0x1f45:0x6 DW_TAG_subrange_type
	.long	8012                            # DW_AT_type
	.byte	4                               # DW_AT_count
	.byte	0                               # End Of Children Mark
	.byte	36                              # Abbrev [36] 0x1f4c:0x7 DW_TAG_base_type
	.long	.Linfo_string304                # DW_AT_name
	.byte	8                               # DW_AT_byte_size
	.byte	7                               # DW_AT_encoding
	.byte	13                              # Abbrev [13] 0x1f53:0x11 DW_TAG_subprogram
	.long	.Linfo_string307                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	108                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1f5e:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1f64:0x11 DW_TAG_subprogram
	.long	.Linfo_string308                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	109                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1f6f:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1f75:0x11 DW_TAG_subprogram
	.long	.Linfo_string309                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	130                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1f80:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1f86:0x11 DW_TAG_subprogram
	.long	.Linfo_string310                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	110                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1f91:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1f97:0x11 DW_TAG_subprogram
	.long	.Linfo_string311                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	111                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1fa2:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1fa8:0x11 DW_TAG_subprogram
	.long	.Linfo_string312                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	113                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1fb3:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1fb9:0x11 DW_TAG_subprogram
	.long	.Linfo_string313                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	112                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1fc4:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1fca:0x11 DW_TAG_subprogram
	.long	.Linfo_string314                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	114                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1fd5:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1fdb:0x11 DW_TAG_subprogram
	.long	.Linfo_string315                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	115                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1fe6:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1fec:0x11 DW_TAG_subprogram
	.long	.Linfo_string316                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	116                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x1ff7:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x1ffd:0x11 DW_TAG_subprogram
	.long	.Linfo_string317                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	117                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2008:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x200e:0x11 DW_TAG_subprogram
	.long	.Linfo_string318                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	118                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2019:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x201f:0x11 DW_TAG_subprogram
	.long	.Linfo_string319                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	122                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x202a:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2030:0x11 DW_TAG_subprogram
	.long	.Linfo_string320                # DW_AT_name
	.byte	30                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x203b:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x2041:0xb DW_TAG_typedef
	.long	3161                            # DW_AT_type
	.long	.Linfo_string321                # DW_AT_name
	.byte	32                              # DW_AT_decl_file
	.byte	20                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0x204c:0xb DW_TAG_typedef
	.long	8279                            # DW_AT_type
	.long	.Linfo_string322                # DW_AT_name
	.byte	34                              # DW_AT_decl_file
	.byte	48                              # DW_AT_decl_line
	.byte	16                              # Abbrev [16] 0x2057:0x5 DW_TAG_pointer_type
	.long	8284                            # DW_AT_type
	.byte	18                              # Abbrev [18] 0x205c:0x5 DW_TAG_const_type
	.long	3034                            # DW_AT_type
	.byte	11                              # Abbrev [11] 0x2061:0xb DW_TAG_typedef
	.long	3190                            # DW_AT_type
	.long	.Linfo_string323                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	38                              # DW_AT_decl_line
	.byte	13                              # Abbrev [13] 0x206c:0x11 DW_TAG_subprogram
	.long	.Linfo_string324                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	95                              # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2077:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x207d:0x11 DW_TAG_subprogram
	.long	.Linfo_string325                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	101                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2088:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x208e:0x11 DW_TAG_subprogram
	.long	.Linfo_string326                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	146                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2099:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x209f:0x11 DW_TAG_subprogram
	.long	.Linfo_string327                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	104                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x20aa:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x20b0:0x11 DW_TAG_subprogram
	.long	.Linfo_string328                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	108                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x20bb:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x20c1:0x11 DW_TAG_subprogram
	.long	.Linfo_string329                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	112                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x20cc:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x20d2:0x11 DW_TAG_subprogram
	.long	.Linfo_string330                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	117                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x20dd:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x20e3:0x11 DW_TAG_subprogram
	.long	.Linfo_string331                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	120                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x20ee:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x20f4:0x11 DW_TAG_subprogram
	.long	.Linfo_string332                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x20ff:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2105:0x11 DW_TAG_subprogram
	.long	.Linfo_string333                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	130                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2110:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2116:0x11 DW_TAG_subprogram
	.long	.Linfo_string334                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	135                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2121:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2127:0x11 DW_TAG_subprogram
	.long	.Linfo_string335                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	140                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2132:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2138:0x16 DW_TAG_subprogram
	.long	.Linfo_string336                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	159                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2143:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2148:0x5 DW_TAG_formal_parameter
	.long	8289                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x214e:0x11 DW_TAG_subprogram
	.long	.Linfo_string337                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	155                             # DW_AT_decl_line
	.long	8289                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2159:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x215f:0x11 DW_TAG_subprogram
	.long	.Linfo_string338                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	166                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x216a:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2170:0x11 DW_TAG_subprogram
	.long	.Linfo_string339                # DW_AT_name
	.byte	35                              # DW_AT_decl_file
	.byte	169                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x217b:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2181:0x16 DW_TAG_subprogram
	.long	.Linfo_string340                # DW_AT_name
	.byte	34                              # DW_AT_decl_file
	.byte	55                              # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x218c:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2191:0x5 DW_TAG_formal_parameter
	.long	8268                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2197:0x11 DW_TAG_subprogram
	.long	.Linfo_string341                # DW_AT_name
	.byte	34                              # DW_AT_decl_file
	.byte	52                              # DW_AT_decl_line
	.long	8268                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x21a2:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x21a8:0xb DW_TAG_typedef
	.long	8627                            # DW_AT_type
	.long	.Linfo_string343                # DW_AT_name
	.byte	37                              # DW_AT_decl_file
	.byte	7                               # DW_AT_decl_line
	.byte	37                              # Abbrev [37] 0x21b3:0x5 DW_TAG_structure_type
	.long	.Linfo_string342                # DW_AT_name
                                        # DW_AT_declaration
	.byte	19                              # Abbrev [19] 0x21b8:0x18 DW_TAG_subprogram
	.long	.Linfo_string344                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	595                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x21c4:0x5 DW_TAG_formal_parameter
	.long	8656                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x21c9:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x21ce:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x21d0:0x5 DW_TAG_restrict_type
	.long	8661                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0x21d5:0x5 DW_TAG_pointer_type
	.long	8666                            # DW_AT_type
	.byte	11                              # Abbrev [11] 0x21da:0xb DW_TAG_typedef
	.long	8627                            # DW_AT_type
	.long	.Linfo_string345                # DW_AT_name
	.byte	39                              # DW_AT_decl_file
	.byte	5                               # DW_AT_decl_line
	.byte	39                              # Abbrev [39] 0x21e5:0x1c DW_TAG_subprogram
	.long	.Linfo_string346                # DW_AT_linkage_name
	.long	.Linfo_string347                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	657                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x21f5:0x5 DW_TAG_formal_parameter
	.long	8656                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x21fa:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x21ff:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2201:0x1d DW_TAG_subprogram
	.long	.Linfo_string348                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	605                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x220d:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2212:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2217:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x221c:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x221e:0x1c DW_TAG_subprogram
	.long	.Linfo_string349                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	613                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x222a:0x5 DW_TAG_formal_parameter
	.long	8656                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x222f:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2234:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x223a:0x5 DW_TAG_pointer_type
	.long	8767                            # DW_AT_type
	.byte	40                              # Abbrev [40] 0x223f:0x30 DW_TAG_structure_type
	.byte	5                               # DW_AT_calling_convention
	.long	.Linfo_string354                # DW_AT_name
	.byte	24                              # DW_AT_byte_size
	.byte	41                              # Abbrev [41] 0x2246:0xa DW_TAG_member
	.long	.Linfo_string350                # DW_AT_name
	.long	3161                            # DW_AT_type
	.byte	0                               # DW_AT_data_member_location
	.byte	41                              # Abbrev [41] 0x2250:0xa DW_TAG_member
	.long	.Linfo_string351                # DW_AT_name
	.long	3161                            # DW_AT_type
	.byte	4                               # DW_AT_data_member_location
	.byte	41                              # Abbrev [41] 0x225a:0xa DW_TAG_member
	.long	.Linfo_string352                # DW_AT_name
	.long	3554                            # DW_AT_type
	.byte	8                               # DW_AT_data_member_location
	.byte	41                              # Abbrev [41] 0x2264:0xa DW_TAG_member
	.long	.Linfo_string353                # DW_AT_name
	.long	3554                            # DW_AT_type
	.byte	16                              # DW_AT_data_member_location
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x226f:0x21 DW_TAG_subprogram
	.long	.Linfo_string355                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	626                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x227b:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2280:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2285:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x228a:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x2290:0x1c DW_TAG_subprogram
	.long	.Linfo_string356                # DW_AT_linkage_name
	.long	.Linfo_string357                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	664                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x22a0:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x22a5:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x22aa:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x22ac:0x20 DW_TAG_subprogram
	.long	.Linfo_string358                # DW_AT_linkage_name
	.long	.Linfo_string359                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	711                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x22bc:0x5 DW_TAG_formal_parameter
	.long	8656                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x22c1:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x22c6:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x22cc:0x20 DW_TAG_subprogram
	.long	.Linfo_string360                # DW_AT_linkage_name
	.long	.Linfo_string361                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	718                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x22dc:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x22e1:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x22e6:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x22ec:0x12 DW_TAG_subprogram
	.long	.Linfo_string362                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	744                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x22f8:0x5 DW_TAG_formal_parameter
	.long	8661                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x22fe:0x1c DW_TAG_subprogram
	.long	.Linfo_string363                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	773                             # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x230a:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x230f:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2314:0x5 DW_TAG_formal_parameter
	.long	8656                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x231a:0x17 DW_TAG_subprogram
	.long	.Linfo_string364                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	758                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2326:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x232b:0x5 DW_TAG_formal_parameter
	.long	8661                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2331:0x17 DW_TAG_subprogram
	.long	.Linfo_string365                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	780                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x233d:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2342:0x5 DW_TAG_formal_parameter
	.long	8656                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2348:0x17 DW_TAG_subprogram
	.long	.Linfo_string366                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	588                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2354:0x5 DW_TAG_formal_parameter
	.long	8661                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2359:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x235f:0x12 DW_TAG_subprogram
	.long	.Linfo_string367                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	745                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x236b:0x5 DW_TAG_formal_parameter
	.long	8661                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2371:0x17 DW_TAG_subprogram
	.long	.Linfo_string368                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	759                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x237d:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2382:0x5 DW_TAG_formal_parameter
	.long	8661                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2388:0x17 DW_TAG_subprogram
	.long	.Linfo_string369                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	788                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2394:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2399:0x5 DW_TAG_formal_parameter
	.long	8661                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x239f:0x17 DW_TAG_subprogram
	.long	.Linfo_string370                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	378                             # DW_AT_decl_line
	.long	4377                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x23ab:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x23b0:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x23b6:0x5 DW_TAG_restrict_type
	.long	9147                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0x23bb:0x5 DW_TAG_pointer_type
	.long	7757                            # DW_AT_type
	.byte	19                              # Abbrev [19] 0x23c0:0x17 DW_TAG_subprogram
	.long	.Linfo_string371                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	383                             # DW_AT_decl_line
	.long	4651                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x23cc:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x23d1:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x23d7:0x17 DW_TAG_subprogram
	.long	.Linfo_string372                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	385                             # DW_AT_decl_line
	.long	4588                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x23e3:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x23e8:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x23ee:0x1c DW_TAG_subprogram
	.long	.Linfo_string373                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	429                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x23fa:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x23ff:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2404:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x240a:0x1c DW_TAG_subprogram
	.long	.Linfo_string374                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	442                             # DW_AT_decl_line
	.long	5413                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2416:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x241b:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2420:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2426:0x1c DW_TAG_subprogram
	.long	.Linfo_string375                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	434                             # DW_AT_decl_line
	.long	3190                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2432:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2437:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x243c:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2442:0x1c DW_TAG_subprogram
	.long	.Linfo_string376                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	449                             # DW_AT_decl_line
	.long	7268                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x244e:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2453:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2458:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x245e:0x16 DW_TAG_subprogram
	.long	.Linfo_string377                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	87                              # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2469:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x246e:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2474:0x1b DW_TAG_subprogram
	.long	.Linfo_string378                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	92                              # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x247f:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2484:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2489:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x248f:0x16 DW_TAG_subprogram
	.long	.Linfo_string379                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	97                              # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x249a:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x249f:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x24a5:0x1b DW_TAG_subprogram
	.long	.Linfo_string380                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	101                             # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x24b0:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x24b5:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x24ba:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x24c0:0x16 DW_TAG_subprogram
	.long	.Linfo_string381                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	106                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x24cb:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x24d0:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x24d6:0x16 DW_TAG_subprogram
	.long	.Linfo_string382                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	131                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x24e1:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x24e6:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x24ec:0x1b DW_TAG_subprogram
	.long	.Linfo_string383                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	109                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x24f7:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x24fc:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2501:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2507:0x1b DW_TAG_subprogram
	.long	.Linfo_string384                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	135                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2512:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2517:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x251c:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2522:0x16 DW_TAG_subprogram
	.long	.Linfo_string385                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	162                             # DW_AT_decl_line
	.long	7853                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x252d:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2532:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2538:0x16 DW_TAG_subprogram
	.long	.Linfo_string386                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	198                             # DW_AT_decl_line
	.long	7853                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2543:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2548:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x254e:0x16 DW_TAG_subprogram
	.long	.Linfo_string387                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	172                             # DW_AT_decl_line
	.long	7853                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2559:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x255e:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2564:0x16 DW_TAG_subprogram
	.long	.Linfo_string388                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	209                             # DW_AT_decl_line
	.long	7853                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x256f:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2574:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x257a:0x1b DW_TAG_subprogram
	.long	.Linfo_string389                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	250                             # DW_AT_decl_line
	.long	7853                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2585:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x258a:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x258f:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2595:0x16 DW_TAG_subprogram
	.long	.Linfo_string390                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	188                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x25a0:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x25a5:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x25ab:0x11 DW_TAG_subprogram
	.long	.Linfo_string391                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	223                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x25b6:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x25bc:0x16 DW_TAG_subprogram
	.long	.Linfo_string392                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	192                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x25c7:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x25cc:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x25d2:0x1b DW_TAG_subprogram
	.long	.Linfo_string393                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.byte	218                             # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x25dd:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x25e2:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x25e7:0x5 DW_TAG_formal_parameter
	.long	9142                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x25ed:0x1c DW_TAG_subprogram
	.long	.Linfo_string394                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	259                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x25f9:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x25fe:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2603:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2609:0x1c DW_TAG_subprogram
	.long	.Linfo_string395                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	263                             # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2615:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x261a:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x261f:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2625:0x1c DW_TAG_subprogram
	.long	.Linfo_string396                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	268                             # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2631:0x5 DW_TAG_formal_parameter
	.long	7757                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2636:0x5 DW_TAG_formal_parameter
	.long	7853                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x263b:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2641:0x1c DW_TAG_subprogram
	.long	.Linfo_string397                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	272                             # DW_AT_decl_line
	.long	7757                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x264d:0x5 DW_TAG_formal_parameter
	.long	7757                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2652:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2657:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x265d:0x21 DW_TAG_subprogram
	.long	.Linfo_string398                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	852                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2669:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x266e:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2673:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2678:0x5 DW_TAG_formal_parameter
	.long	4548                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x267e:0x12 DW_TAG_subprogram
	.long	.Linfo_string399                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	285                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x268a:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2690:0x12 DW_TAG_subprogram
	.long	.Linfo_string400                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	289                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x269c:0x5 DW_TAG_formal_parameter
	.long	8257                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x26a2:0x12 DW_TAG_subprogram
	.long	.Linfo_string401                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	293                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x26ae:0x5 DW_TAG_formal_parameter
	.long	9908                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x26b4:0x5 DW_TAG_pointer_type
	.long	9913                            # DW_AT_type
	.byte	18                              # Abbrev [18] 0x26b9:0x5 DW_TAG_const_type
	.long	7918                            # DW_AT_type
	.byte	19                              # Abbrev [19] 0x26be:0x1c DW_TAG_subprogram
	.long	.Linfo_string402                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	308                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x26ca:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x26cf:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x26d4:0x5 DW_TAG_formal_parameter
	.long	9946                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x26da:0x5 DW_TAG_restrict_type
	.long	9951                            # DW_AT_type
	.byte	16                              # Abbrev [16] 0x26df:0x5 DW_TAG_pointer_type
	.long	7918                            # DW_AT_type
	.byte	19                              # Abbrev [19] 0x26e4:0x21 DW_TAG_subprogram
	.long	.Linfo_string403                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	297                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x26f0:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x26f5:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x26fa:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x26ff:0x5 DW_TAG_formal_parameter
	.long	9946                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2705:0x1c DW_TAG_subprogram
	.long	.Linfo_string404                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	302                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2711:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2716:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x271b:0x5 DW_TAG_formal_parameter
	.long	9946                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2721:0x21 DW_TAG_subprogram
	.long	.Linfo_string405                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	338                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x272d:0x5 DW_TAG_formal_parameter
	.long	7752                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2732:0x5 DW_TAG_formal_parameter
	.long	10050                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2737:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x273c:0x5 DW_TAG_formal_parameter
	.long	9946                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x2742:0x5 DW_TAG_restrict_type
	.long	10055                           # DW_AT_type
	.byte	16                              # Abbrev [16] 0x2747:0x5 DW_TAG_pointer_type
	.long	3653                            # DW_AT_type
	.byte	19                              # Abbrev [19] 0x274c:0x21 DW_TAG_subprogram
	.long	.Linfo_string406                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	344                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2758:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x275d:0x5 DW_TAG_formal_parameter
	.long	10093                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2762:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2767:0x5 DW_TAG_formal_parameter
	.long	9946                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x276d:0x5 DW_TAG_restrict_type
	.long	10098                           # DW_AT_type
	.byte	16                              # Abbrev [16] 0x2772:0x5 DW_TAG_pointer_type
	.long	7853                            # DW_AT_type
	.byte	26                              # Abbrev [26] 0x2777:0xc DW_TAG_subprogram
	.long	.Linfo_string407                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	751                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	39                              # Abbrev [39] 0x2783:0x1b DW_TAG_subprogram
	.long	.Linfo_string408                # DW_AT_linkage_name
	.long	.Linfo_string409                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	715                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2793:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2798:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x279e:0x17 DW_TAG_subprogram
	.long	.Linfo_string410                # DW_AT_linkage_name
	.long	.Linfo_string411                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	661                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x27ae:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x27b3:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x27b5:0x12 DW_TAG_subprogram
	.long	.Linfo_string412                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	765                             # DW_AT_decl_line
	.long	8257                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x27c1:0x5 DW_TAG_formal_parameter
	.long	7762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x27c7:0x17 DW_TAG_subprogram
	.long	.Linfo_string413                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	621                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x27d3:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x27d8:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x27de:0x13 DW_TAG_subprogram
	.long	.Linfo_string414                # DW_AT_name
	.byte	38                              # DW_AT_decl_file
	.short	602                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x27ea:0x5 DW_TAG_formal_parameter
	.long	7848                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x27ef:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	11                              # Abbrev [11] 0x27f1:0xb DW_TAG_typedef
	.long	10236                           # DW_AT_type
	.long	.Linfo_string417                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	84                              # DW_AT_decl_line
	.byte	11                              # Abbrev [11] 0x27fc:0xb DW_TAG_typedef
	.long	10247                           # DW_AT_type
	.long	.Linfo_string416                # DW_AT_name
	.byte	41                              # DW_AT_decl_file
	.byte	14                              # DW_AT_decl_line
	.byte	37                              # Abbrev [37] 0x2807:0x5 DW_TAG_structure_type
	.long	.Linfo_string415                # DW_AT_name
                                        # DW_AT_declaration
	.byte	13                              # Abbrev [13] 0x280c:0x11 DW_TAG_subprogram
	.long	.Linfo_string418                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	178                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2817:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x281d:0x5 DW_TAG_pointer_type
	.long	8616                            # DW_AT_type
	.byte	13                              # Abbrev [13] 0x2822:0x11 DW_TAG_subprogram
	.long	.Linfo_string419                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	230                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x282d:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	27                              # Abbrev [27] 0x2833:0x13 DW_TAG_subprogram
	.long	.Linfo_string420                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	328                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x283b:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2840:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x2846:0x5 DW_TAG_restrict_type
	.long	10269                           # DW_AT_type
	.byte	19                              # Abbrev [19] 0x284b:0x21 DW_TAG_subprogram
	.long	.Linfo_string421                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	332                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2857:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x285c:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2861:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2866:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x286c:0x18 DW_TAG_subprogram
	.long	.Linfo_string422                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	350                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2878:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x287d:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x2882:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x2884:0x1c DW_TAG_subprogram
	.long	.Linfo_string423                # DW_AT_linkage_name
	.long	.Linfo_string424                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	434                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2894:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2899:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x289e:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x28a0:0x1d DW_TAG_subprogram
	.long	.Linfo_string425                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	378                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x28ac:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x28b1:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x28b6:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x28bb:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x28bd:0x18 DW_TAG_subprogram
	.long	.Linfo_string426                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	358                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x28c9:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x28ce:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x28d3:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x28d5:0x1c DW_TAG_subprogram
	.long	.Linfo_string427                # DW_AT_linkage_name
	.long	.Linfo_string428                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	439                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x28e5:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x28ea:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x28ef:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x28f1:0x1c DW_TAG_subprogram
	.long	.Linfo_string429                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	365                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x28fd:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2902:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2907:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x290d:0x20 DW_TAG_subprogram
	.long	.Linfo_string430                # DW_AT_linkage_name
	.long	.Linfo_string431                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	479                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x291d:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2922:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2927:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x292d:0x20 DW_TAG_subprogram
	.long	.Linfo_string432                # DW_AT_linkage_name
	.long	.Linfo_string433                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	487                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x293d:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2942:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2947:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x294d:0x21 DW_TAG_subprogram
	.long	.Linfo_string434                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	382                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2959:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x295e:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2963:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2968:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x296e:0x1c DW_TAG_subprogram
	.long	.Linfo_string435                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	373                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x297a:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x297f:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2984:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x298a:0x12 DW_TAG_subprogram
	.long	.Linfo_string436                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	513                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2996:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x299c:0x1c DW_TAG_subprogram
	.long	.Linfo_string437                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	592                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x29a8:0x5 DW_TAG_formal_parameter
	.long	3643                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x29ad:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x29b2:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x29b8:0x17 DW_TAG_subprogram
	.long	.Linfo_string438                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	549                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x29c4:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x29c9:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x29cf:0x17 DW_TAG_subprogram
	.long	.Linfo_string439                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	655                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x29db:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x29e0:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x29e6:0x12 DW_TAG_subprogram
	.long	.Linfo_string440                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	514                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x29f2:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x29f8:0x17 DW_TAG_subprogram
	.long	.Linfo_string441                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	550                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2a04:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a09:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2a0f:0x17 DW_TAG_subprogram
	.long	.Linfo_string442                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	668                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2a1b:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a20:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2a26:0x21 DW_TAG_subprogram
	.long	.Linfo_string443                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	675                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2a32:0x5 DW_TAG_formal_parameter
	.long	3555                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a37:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a3c:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a41:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2a47:0x21 DW_TAG_subprogram
	.long	.Linfo_string444                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	681                             # DW_AT_decl_line
	.long	3571                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2a53:0x5 DW_TAG_formal_parameter
	.long	3560                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a58:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a5d:0x5 DW_TAG_formal_parameter
	.long	3571                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a62:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2a68:0x17 DW_TAG_subprogram
	.long	.Linfo_string445                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	760                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2a74:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a79:0x5 DW_TAG_formal_parameter
	.long	10879                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	15                              # Abbrev [15] 0x2a7f:0x5 DW_TAG_restrict_type
	.long	10884                           # DW_AT_type
	.byte	16                              # Abbrev [16] 0x2a84:0x5 DW_TAG_pointer_type
	.long	10225                           # DW_AT_type
	.byte	19                              # Abbrev [19] 0x2a89:0x1c DW_TAG_subprogram
	.long	.Linfo_string446                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	713                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2a95:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a9a:0x5 DW_TAG_formal_parameter
	.long	3074                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2a9f:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2aa5:0x17 DW_TAG_subprogram
	.long	.Linfo_string447                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	765                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2ab1:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2ab6:0x5 DW_TAG_formal_parameter
	.long	10940                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	16                              # Abbrev [16] 0x2abc:0x5 DW_TAG_pointer_type
	.long	10945                           # DW_AT_type
	.byte	18                              # Abbrev [18] 0x2ac1:0x5 DW_TAG_const_type
	.long	10225                           # DW_AT_type
	.byte	19                              # Abbrev [19] 0x2ac6:0x12 DW_TAG_subprogram
	.long	.Linfo_string448                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	718                             # DW_AT_decl_line
	.long	3074                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2ad2:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	27                              # Abbrev [27] 0x2ad8:0xe DW_TAG_subprogram
	.long	.Linfo_string449                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	723                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2ae0:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	27                              # Abbrev [27] 0x2ae6:0xe DW_TAG_subprogram
	.long	.Linfo_string450                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	786                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2aee:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2af4:0x12 DW_TAG_subprogram
	.long	.Linfo_string451                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	788                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b00:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2b06:0x12 DW_TAG_subprogram
	.long	.Linfo_string452                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	790                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b12:0x5 DW_TAG_formal_parameter
	.long	10269                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	27                              # Abbrev [27] 0x2b18:0xe DW_TAG_subprogram
	.long	.Linfo_string453                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	804                             # DW_AT_decl_line
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b20:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2b26:0x17 DW_TAG_subprogram
	.long	.Linfo_string454                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	258                             # DW_AT_decl_line
	.long	10269                           # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b32:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2b37:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2b3d:0x1c DW_TAG_subprogram
	.long	.Linfo_string455                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	265                             # DW_AT_decl_line
	.long	10269                           # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b49:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2b4e:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2b53:0x5 DW_TAG_formal_parameter
	.long	10310                           # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2b59:0x11 DW_TAG_subprogram
	.long	.Linfo_string456                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	152                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b64:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	13                              # Abbrev [13] 0x2b6a:0x16 DW_TAG_subprogram
	.long	.Linfo_string457                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	154                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b75:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2b7a:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	22                              # Abbrev [22] 0x2b80:0xb DW_TAG_subprogram
	.long	.Linfo_string458                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	188                             # DW_AT_decl_line
	.long	10269                           # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	13                              # Abbrev [13] 0x2b8b:0x11 DW_TAG_subprogram
	.long	.Linfo_string459                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.byte	205                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2b96:0x5 DW_TAG_formal_parameter
	.long	3631                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	26                              # Abbrev [26] 0x2b9c:0xc DW_TAG_subprogram
	.long	.Linfo_string460                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	520                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	39                              # Abbrev [39] 0x2ba8:0x17 DW_TAG_subprogram
	.long	.Linfo_string461                # DW_AT_linkage_name
	.long	.Linfo_string462                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	437                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2bb8:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x2bbd:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	39                              # Abbrev [39] 0x2bbf:0x1b DW_TAG_subprogram
	.long	.Linfo_string463                # DW_AT_linkage_name
	.long	.Linfo_string464                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	484                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2bcf:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2bd4:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2bda:0x13 DW_TAG_subprogram
	.long	.Linfo_string465                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	356                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2be6:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	38                              # Abbrev [38] 0x2beb:0x1 DW_TAG_unspecified_parameters
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2bed:0x12 DW_TAG_subprogram
	.long	.Linfo_string466                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	556                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2bf9:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2bff:0x12 DW_TAG_subprogram
	.long	.Linfo_string467                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	661                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2c0b:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	19                              # Abbrev [19] 0x2c11:0x17 DW_TAG_subprogram
	.long	.Linfo_string468                # DW_AT_name
	.byte	42                              # DW_AT_decl_file
	.short	371                             # DW_AT_decl_line
	.long	3045                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2c1d:0x5 DW_TAG_formal_parameter
	.long	3648                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2c22:0x5 DW_TAG_formal_parameter
	.long	8762                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	37                              # Abbrev [37] 0x2c28:0x5 DW_TAG_structure_type
	.long	.Linfo_string469                # DW_AT_name
                                        # DW_AT_declaration
	.byte	13                              # Abbrev [13] 0x2c2d:0x16 DW_TAG_subprogram
	.long	.Linfo_string470                # DW_AT_name
	.byte	44                              # DW_AT_decl_file
	.byte	122                             # DW_AT_decl_line
	.long	3631                            # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	9                               # Abbrev [9] 0x2c38:0x5 DW_TAG_formal_parameter
	.long	3045                            # DW_AT_type
	.byte	9                               # Abbrev [9] 0x2c3d:0x5 DW_TAG_formal_parameter
	.long	3653                            # DW_AT_type
	.byte	0                               # End Of Children Mark
	.byte	22                              # Abbrev [22] 0x2c43:0xb DW_TAG_subprogram
	.long	.Linfo_string471                # DW_AT_name
	.byte	44                              # DW_AT_decl_file
	.byte	125                             # DW_AT_decl_line
	.long	11342                           # DW_AT_type
                                        # DW_AT_declaration
                                        # DW_AT_external
	.byte	16                              # Abbrev [16] 0x2c4e:0x5 DW_TAG_pointer_type
	.long	11304                           # DW_AT_type
	.byte	11                              # Abbrev [11] 0x2c53:0xb DW_TAG_typedef
	.long	11358                           # DW_AT_type
	.long	.Linfo_string473                # DW_AT_name
	.byte	45                              # DW_AT_decl_file
	.byte	12                              # DW_AT_decl_line
	.byte	42                              # Abbrev [42] 0x2c5e:0x9 DW_TAG_typedef
	.long	11367                           # DW_AT_type
	.long	.Linfo_string472                # DW_AT_name
	.byte	34                              # Abbrev [34] 0x2c67:0xc DW_TAG_array_type
	.long	8767                            # DW_AT_type
	.byte	35                              # Abbrev [35] 0x2c6c:0x6 DW_TAG_subrange_type
	.long	8012                            # DW_AT_type
	.byte	1                               # DW_AT_count
	.byte	0                               # End Of Children Mark
	.byte	0                               # End Of Children Mark
.Ldebug_info_end0:
	.section	.debug_str,"MS",@progbits,1
.Linfo_string0:
	.asciz	"clang version 22.1.8"          # string offset=0
.Linfo_string1:
	.asciz	"/tmp/dem3d/x.cpp"              # string offset=21
.Linfo_string2:
	.asciz	"/tmp/wt/dem3d"                 # string offset=38
.Linfo_string3:
	.asciz	"std"                           # string offset=52
.Linfo_string4:
	.asciz	"__1"                           # string offset=56
.Linfo_string5:
	.asciz	"signed char"                   # string offset=60
.Linfo_string6:
	.asciz	"__int8_t"                      # string offset=72
.Linfo_string7:
	.asciz	"int8_t"                        # string offset=81
.Linfo_string8:
	.asciz	"short"                         # string offset=88
.Linfo_string9:
	.asciz	"__int16_t"                     # string offset=94
.Linfo_string10:
	.asciz	"int16_t"                       # string offset=104
.Linfo_string11:
	.asciz	"int"                           # string offset=112
.Linfo_string12:
	.asciz	"__int32_t"                     # string offset=116
.Linfo_string13:
	.asciz	"int32_t"                       # string offset=126
.Linfo_string14:
	.asciz	"long"                          # string offset=134
.Linfo_string15:
	.asciz	"__int64_t"                     # string offset=139
.Linfo_string16:
	.asciz	"int64_t"                       # string offset=149
.Linfo_string17:
	.asciz	"unsigned char"                 # string offset=157
.Linfo_string18:
	.asciz	"__uint8_t"                     # string offset=171
.Linfo_string19:
	.asciz	"uint8_t"                       # string offset=181
.Linfo_string20:
	.asciz	"unsigned short"                # string offset=189
.Linfo_string21:
	.asciz	"__uint16_t"                    # string offset=204
.Linfo_string22:
	.asciz	"uint16_t"                      # string offset=215
.Linfo_string23:
	.asciz	"unsigned int"                  # string offset=224
.Linfo_string24:
	.asciz	"__uint32_t"                    # string offset=237
.Linfo_string25:
	.asciz	"uint32_t"                      # string offset=248
.Linfo_string26:
	.asciz	"unsigned long"                 # string offset=257
.Linfo_string27:
	.asciz	"__uint64_t"                    # string offset=271
.Linfo_string28:
	.asciz	"uint64_t"                      # string offset=282
.Linfo_string29:
	.asciz	"__int_least8_t"                # string offset=291
.Linfo_string30:
	.asciz	"int_least8_t"                  # string offset=306
.Linfo_string31:
	.asciz	"__int_least16_t"               # string offset=319
.Linfo_string32:
	.asciz	"int_least16_t"                 # string offset=335
.Linfo_string33:
	.asciz	"__int_least32_t"               # string offset=349
.Linfo_string34:
	.asciz	"int_least32_t"                 # string offset=365
.Linfo_string35:
	.asciz	"__int_least64_t"               # string offset=379
.Linfo_string36:
	.asciz	"int_least64_t"                 # string offset=395
.Linfo_string37:
	.asciz	"__uint_least8_t"               # string offset=409
.Linfo_string38:
	.asciz	"uint_least8_t"                 # string offset=425
.Linfo_string39:
	.asciz	"__uint_least16_t"              # string offset=439
.Linfo_string40:
	.asciz	"uint_least16_t"                # string offset=456
.Linfo_string41:
	.asciz	"__uint_least32_t"              # string offset=471
.Linfo_string42:
	.asciz	"uint_least32_t"                # string offset=488
.Linfo_string43:
	.asciz	"__uint_least64_t"              # string offset=503
.Linfo_string44:
	.asciz	"uint_least64_t"                # string offset=520
.Linfo_string45:
	.asciz	"int_fast8_t"                   # string offset=535
.Linfo_string46:
	.asciz	"int_fast16_t"                  # string offset=547
.Linfo_string47:
	.asciz	"int_fast32_t"                  # string offset=560
.Linfo_string48:
	.asciz	"int_fast64_t"                  # string offset=573
.Linfo_string49:
	.asciz	"uint_fast8_t"                  # string offset=586
.Linfo_string50:
	.asciz	"uint_fast16_t"                 # string offset=599
.Linfo_string51:
	.asciz	"uint_fast32_t"                 # string offset=613
.Linfo_string52:
	.asciz	"uint_fast64_t"                 # string offset=627
.Linfo_string53:
	.asciz	"intptr_t"                      # string offset=641
.Linfo_string54:
	.asciz	"uintptr_t"                     # string offset=650
.Linfo_string55:
	.asciz	"__intmax_t"                    # string offset=660
.Linfo_string56:
	.asciz	"intmax_t"                      # string offset=671
.Linfo_string57:
	.asciz	"__uintmax_t"                   # string offset=680
.Linfo_string58:
	.asciz	"uintmax_t"                     # string offset=692
.Linfo_string59:
	.asciz	"memcpy"                        # string offset=702
.Linfo_string60:
	.asciz	"size_t"                        # string offset=709
.Linfo_string61:
	.asciz	"memmove"                       # string offset=716
.Linfo_string62:
	.asciz	"strcpy"                        # string offset=724
.Linfo_string63:
	.asciz	"char"                          # string offset=731
.Linfo_string64:
	.asciz	"strncpy"                       # string offset=736
.Linfo_string65:
	.asciz	"strcat"                        # string offset=744
.Linfo_string66:
	.asciz	"strncat"                       # string offset=751
.Linfo_string67:
	.asciz	"memcmp"                        # string offset=759
.Linfo_string68:
	.asciz	"strcmp"                        # string offset=766
.Linfo_string69:
	.asciz	"strncmp"                       # string offset=773
.Linfo_string70:
	.asciz	"strcoll"                       # string offset=781
.Linfo_string71:
	.asciz	"strxfrm"                       # string offset=789
.Linfo_string72:
	.asciz	"memchr"                        # string offset=797
.Linfo_string73:
	.asciz	"strchr"                        # string offset=804
.Linfo_string74:
	.asciz	"strcspn"                       # string offset=811
.Linfo_string75:
	.asciz	"strpbrk"                       # string offset=819
.Linfo_string76:
	.asciz	"strrchr"                       # string offset=827
.Linfo_string77:
	.asciz	"strspn"                        # string offset=835
.Linfo_string78:
	.asciz	"strstr"                        # string offset=842
.Linfo_string79:
	.asciz	"strtok"                        # string offset=849
.Linfo_string80:
	.asciz	"memset"                        # string offset=856
.Linfo_string81:
	.asciz	"strerror"                      # string offset=863
.Linfo_string82:
	.asciz	"strlen"                        # string offset=872
.Linfo_string83:
	.asciz	"chrono"                        # string offset=879
.Linfo_string84:
	.asciz	"literals"                      # string offset=886
.Linfo_string85:
	.asciz	"chrono_literals"               # string offset=895
.Linfo_string86:
	.asciz	"__clock_t"                     # string offset=911
.Linfo_string87:
	.asciz	"clock_t"                       # string offset=921
.Linfo_string88:
	.asciz	"__time_t"                      # string offset=929
.Linfo_string89:
	.asciz	"time_t"                        # string offset=938
.Linfo_string90:
	.asciz	"tm_sec"                        # string offset=945
.Linfo_string91:
	.asciz	"tm_min"                        # string offset=952
.Linfo_string92:
	.asciz	"tm_hour"                       # string offset=959
.Linfo_string93:
	.asciz	"tm_mday"                       # string offset=967
.Linfo_string94:
	.asciz	"tm_mon"                        # string offset=975
.Linfo_string95:
	.asciz	"tm_year"                       # string offset=982
.Linfo_string96:
	.asciz	"tm_wday"                       # string offset=990
.Linfo_string97:
	.asciz	"tm_yday"                       # string offset=998
.Linfo_string98:
	.asciz	"tm_isdst"                      # string offset=1006
.Linfo_string99:
	.asciz	"tm_gmtoff"                     # string offset=1015
.Linfo_string100:
	.asciz	"tm_zone"                       # string offset=1025
.Linfo_string101:
	.asciz	"tm"                            # string offset=1033
.Linfo_string102:
	.asciz	"tv_sec"                        # string offset=1036
.Linfo_string103:
	.asciz	"tv_nsec"                       # string offset=1043
.Linfo_string104:
	.asciz	"__syscall_slong_t"             # string offset=1051
.Linfo_string105:
	.asciz	"timespec"                      # string offset=1069
.Linfo_string106:
	.asciz	"clock"                         # string offset=1078
.Linfo_string107:
	.asciz	"difftime"                      # string offset=1084
.Linfo_string108:
	.asciz	"double"                        # string offset=1093
.Linfo_string109:
	.asciz	"mktime"                        # string offset=1100
.Linfo_string110:
	.asciz	"time"                          # string offset=1107
.Linfo_string111:
	.asciz	"asctime"                       # string offset=1112
.Linfo_string112:
	.asciz	"ctime"                         # string offset=1120
.Linfo_string113:
	.asciz	"gmtime"                        # string offset=1126
.Linfo_string114:
	.asciz	"localtime"                     # string offset=1133
.Linfo_string115:
	.asciz	"strftime"                      # string offset=1143
.Linfo_string116:
	.asciz	"timespec_get"                  # string offset=1152
.Linfo_string117:
	.asciz	"__math"                        # string offset=1165
.Linfo_string118:
	.asciz	"_ZNSt3__16__math8isfiniteB9nie220108Ee" # string offset=1172
.Linfo_string119:
	.asciz	"isfinite"                      # string offset=1211
.Linfo_string120:
	.asciz	"bool"                          # string offset=1220
.Linfo_string121:
	.asciz	"long double"                   # string offset=1225
.Linfo_string122:
	.asciz	"_ZNSt3__16__math5isinfB9nie220108Ee" # string offset=1237
.Linfo_string123:
	.asciz	"isinf"                         # string offset=1273
.Linfo_string124:
	.asciz	"_ZNSt3__16__math5isnanB9nie220108Ee" # string offset=1279
.Linfo_string125:
	.asciz	"isnan"                         # string offset=1315
.Linfo_string126:
	.asciz	"_ZNSt3__16__math8isnormalB9nie220108Ee" # string offset=1321
.Linfo_string127:
	.asciz	"isnormal"                      # string offset=1360
.Linfo_string128:
	.asciz	"_ZNSt3__16__math4modfB9nie220108EePe" # string offset=1369
.Linfo_string129:
	.asciz	"modf"                          # string offset=1406
.Linfo_string130:
	.asciz	"float"                         # string offset=1411
.Linfo_string131:
	.asciz	"float_t"                       # string offset=1417
.Linfo_string132:
	.asciz	"double_t"                      # string offset=1425
.Linfo_string133:
	.asciz	"acosf"                         # string offset=1434
.Linfo_string134:
	.asciz	"asinf"                         # string offset=1440
.Linfo_string135:
	.asciz	"atanf"                         # string offset=1446
.Linfo_string136:
	.asciz	"atan2f"                        # string offset=1452
.Linfo_string137:
	.asciz	"ceilf"                         # string offset=1459
.Linfo_string138:
	.asciz	"cosf"                          # string offset=1465
.Linfo_string139:
	.asciz	"coshf"                         # string offset=1470
.Linfo_string140:
	.asciz	"expf"                          # string offset=1476
.Linfo_string141:
	.asciz	"fabsf"                         # string offset=1481
.Linfo_string142:
	.asciz	"floorf"                        # string offset=1487
.Linfo_string143:
	.asciz	"fmodf"                         # string offset=1494
.Linfo_string144:
	.asciz	"frexpf"                        # string offset=1500
.Linfo_string145:
	.asciz	"ldexpf"                        # string offset=1507
.Linfo_string146:
	.asciz	"logf"                          # string offset=1514
.Linfo_string147:
	.asciz	"log10f"                        # string offset=1519
.Linfo_string148:
	.asciz	"modff"                         # string offset=1526
.Linfo_string149:
	.asciz	"powf"                          # string offset=1532
.Linfo_string150:
	.asciz	"sinf"                          # string offset=1537
.Linfo_string151:
	.asciz	"sinhf"                         # string offset=1542
.Linfo_string152:
	.asciz	"sqrtf"                         # string offset=1548
.Linfo_string153:
	.asciz	"tanf"                          # string offset=1554
.Linfo_string154:
	.asciz	"tanhf"                         # string offset=1559
.Linfo_string155:
	.asciz	"acoshf"                        # string offset=1565
.Linfo_string156:
	.asciz	"asinhf"                        # string offset=1572
.Linfo_string157:
	.asciz	"atanhf"                        # string offset=1579
.Linfo_string158:
	.asciz	"cbrtf"                         # string offset=1586
.Linfo_string159:
	.asciz	"copysignf"                     # string offset=1592
.Linfo_string160:
	.asciz	"erff"                          # string offset=1602
.Linfo_string161:
	.asciz	"erfcf"                         # string offset=1607
.Linfo_string162:
	.asciz	"exp2f"                         # string offset=1613
.Linfo_string163:
	.asciz	"expm1f"                        # string offset=1619
.Linfo_string164:
	.asciz	"fdimf"                         # string offset=1626
.Linfo_string165:
	.asciz	"fmaf"                          # string offset=1632
.Linfo_string166:
	.asciz	"fmaxf"                         # string offset=1637
.Linfo_string167:
	.asciz	"fminf"                         # string offset=1643
.Linfo_string168:
	.asciz	"hypotf"                        # string offset=1649
.Linfo_string169:
	.asciz	"ilogbf"                        # string offset=1656
.Linfo_string170:
	.asciz	"lgammaf"                       # string offset=1663
.Linfo_string171:
	.asciz	"llrintf"                       # string offset=1671
.Linfo_string172:
	.asciz	"long long"                     # string offset=1679
.Linfo_string173:
	.asciz	"llroundf"                      # string offset=1689
.Linfo_string174:
	.asciz	"log1pf"                        # string offset=1698
.Linfo_string175:
	.asciz	"log2f"                         # string offset=1705
.Linfo_string176:
	.asciz	"logbf"                         # string offset=1711
.Linfo_string177:
	.asciz	"lrintf"                        # string offset=1717
.Linfo_string178:
	.asciz	"lroundf"                       # string offset=1724
.Linfo_string179:
	.asciz	"nan"                           # string offset=1732
.Linfo_string180:
	.asciz	"nanf"                          # string offset=1736
.Linfo_string181:
	.asciz	"nearbyintf"                    # string offset=1741
.Linfo_string182:
	.asciz	"nextafterf"                    # string offset=1752
.Linfo_string183:
	.asciz	"nexttowardf"                   # string offset=1763
.Linfo_string184:
	.asciz	"remainderf"                    # string offset=1775
.Linfo_string185:
	.asciz	"remquof"                       # string offset=1786
.Linfo_string186:
	.asciz	"rintf"                         # string offset=1794
.Linfo_string187:
	.asciz	"roundf"                        # string offset=1800
.Linfo_string188:
	.asciz	"scalblnf"                      # string offset=1807
.Linfo_string189:
	.asciz	"scalbnf"                       # string offset=1816
.Linfo_string190:
	.asciz	"tgammaf"                       # string offset=1824
.Linfo_string191:
	.asciz	"truncf"                        # string offset=1832
.Linfo_string192:
	.asciz	"acosl"                         # string offset=1839
.Linfo_string193:
	.asciz	"asinl"                         # string offset=1845
.Linfo_string194:
	.asciz	"atanl"                         # string offset=1851
.Linfo_string195:
	.asciz	"atan2l"                        # string offset=1857
.Linfo_string196:
	.asciz	"ceill"                         # string offset=1864
.Linfo_string197:
	.asciz	"cosl"                          # string offset=1870
.Linfo_string198:
	.asciz	"coshl"                         # string offset=1875
.Linfo_string199:
	.asciz	"expl"                          # string offset=1881
.Linfo_string200:
	.asciz	"fabsl"                         # string offset=1886
.Linfo_string201:
	.asciz	"floorl"                        # string offset=1892
.Linfo_string202:
	.asciz	"fmodl"                         # string offset=1899
.Linfo_string203:
	.asciz	"frexpl"                        # string offset=1905
.Linfo_string204:
	.asciz	"ldexpl"                        # string offset=1912
.Linfo_string205:
	.asciz	"logl"                          # string offset=1919
.Linfo_string206:
	.asciz	"log10l"                        # string offset=1924
.Linfo_string207:
	.asciz	"modfl"                         # string offset=1931
.Linfo_string208:
	.asciz	"powl"                          # string offset=1937
.Linfo_string209:
	.asciz	"sinl"                          # string offset=1942
.Linfo_string210:
	.asciz	"sinhl"                         # string offset=1947
.Linfo_string211:
	.asciz	"sqrtl"                         # string offset=1953
.Linfo_string212:
	.asciz	"tanl"                          # string offset=1959
.Linfo_string213:
	.asciz	"tanhl"                         # string offset=1964
.Linfo_string214:
	.asciz	"acoshl"                        # string offset=1970
.Linfo_string215:
	.asciz	"asinhl"                        # string offset=1977
.Linfo_string216:
	.asciz	"atanhl"                        # string offset=1984
.Linfo_string217:
	.asciz	"cbrtl"                         # string offset=1991
.Linfo_string218:
	.asciz	"copysignl"                     # string offset=1997
.Linfo_string219:
	.asciz	"erfl"                          # string offset=2007
.Linfo_string220:
	.asciz	"erfcl"                         # string offset=2012
.Linfo_string221:
	.asciz	"exp2l"                         # string offset=2018
.Linfo_string222:
	.asciz	"expm1l"                        # string offset=2024
.Linfo_string223:
	.asciz	"fdiml"                         # string offset=2031
.Linfo_string224:
	.asciz	"fmal"                          # string offset=2037
.Linfo_string225:
	.asciz	"fmaxl"                         # string offset=2042
.Linfo_string226:
	.asciz	"fminl"                         # string offset=2048
.Linfo_string227:
	.asciz	"hypotl"                        # string offset=2054
.Linfo_string228:
	.asciz	"ilogbl"                        # string offset=2061
.Linfo_string229:
	.asciz	"lgammal"                       # string offset=2068
.Linfo_string230:
	.asciz	"llrintl"                       # string offset=2076
.Linfo_string231:
	.asciz	"llroundl"                      # string offset=2084
.Linfo_string232:
	.asciz	"log1pl"                        # string offset=2093
.Linfo_string233:
	.asciz	"log2l"                         # string offset=2100
.Linfo_string234:
	.asciz	"logbl"                         # string offset=2106
.Linfo_string235:
	.asciz	"lrintl"                        # string offset=2112
.Linfo_string236:
	.asciz	"lroundl"                       # string offset=2119
.Linfo_string237:
	.asciz	"nanl"                          # string offset=2127
.Linfo_string238:
	.asciz	"nearbyintl"                    # string offset=2132
.Linfo_string239:
	.asciz	"nextafterl"                    # string offset=2143
.Linfo_string240:
	.asciz	"nexttowardl"                   # string offset=2154
.Linfo_string241:
	.asciz	"remainderl"                    # string offset=2166
.Linfo_string242:
	.asciz	"remquol"                       # string offset=2177
.Linfo_string243:
	.asciz	"rintl"                         # string offset=2185
.Linfo_string244:
	.asciz	"roundl"                        # string offset=2191
.Linfo_string245:
	.asciz	"scalblnl"                      # string offset=2198
.Linfo_string246:
	.asciz	"scalbnl"                       # string offset=2207
.Linfo_string247:
	.asciz	"tgammal"                       # string offset=2215
.Linfo_string248:
	.asciz	"truncl"                        # string offset=2223
.Linfo_string249:
	.asciz	"__clang_max_align_nonce1"      # string offset=2230
.Linfo_string250:
	.asciz	"__clang_max_align_nonce2"      # string offset=2255
.Linfo_string251:
	.asciz	"max_align_t"                   # string offset=2280
.Linfo_string252:
	.asciz	"div_t"                         # string offset=2292
.Linfo_string253:
	.asciz	"quot"                          # string offset=2298
.Linfo_string254:
	.asciz	"rem"                           # string offset=2303
.Linfo_string255:
	.asciz	"ldiv_t"                        # string offset=2307
.Linfo_string256:
	.asciz	"lldiv_t"                       # string offset=2314
.Linfo_string257:
	.asciz	"atof"                          # string offset=2322
.Linfo_string258:
	.asciz	"atoi"                          # string offset=2327
.Linfo_string259:
	.asciz	"atol"                          # string offset=2332
.Linfo_string260:
	.asciz	"atoll"                         # string offset=2337
.Linfo_string261:
	.asciz	"strtod"                        # string offset=2343
.Linfo_string262:
	.asciz	"strtof"                        # string offset=2350
.Linfo_string263:
	.asciz	"strtold"                       # string offset=2357
.Linfo_string264:
	.asciz	"strtol"                        # string offset=2365
.Linfo_string265:
	.asciz	"strtoll"                       # string offset=2372
.Linfo_string266:
	.asciz	"strtoul"                       # string offset=2380
.Linfo_string267:
	.asciz	"strtoull"                      # string offset=2388
.Linfo_string268:
	.asciz	"unsigned long long"            # string offset=2397
.Linfo_string269:
	.asciz	"rand"                          # string offset=2416
.Linfo_string270:
	.asciz	"srand"                         # string offset=2421
.Linfo_string271:
	.asciz	"calloc"                        # string offset=2427
.Linfo_string272:
	.asciz	"free"                          # string offset=2434
.Linfo_string273:
	.asciz	"malloc"                        # string offset=2439
.Linfo_string274:
	.asciz	"realloc"                       # string offset=2446
.Linfo_string275:
	.asciz	"abort"                         # string offset=2454
.Linfo_string276:
	.asciz	"atexit"                        # string offset=2460
.Linfo_string277:
	.asciz	"exit"                          # string offset=2467
.Linfo_string278:
	.asciz	"_Exit"                         # string offset=2472
.Linfo_string279:
	.asciz	"getenv"                        # string offset=2478
.Linfo_string280:
	.asciz	"system"                        # string offset=2485
.Linfo_string281:
	.asciz	"bsearch"                       # string offset=2492
.Linfo_string282:
	.asciz	"__compar_fn_t"                 # string offset=2500
.Linfo_string283:
	.asciz	"qsort"                         # string offset=2514
.Linfo_string284:
	.asciz	"abs"                           # string offset=2520
.Linfo_string285:
	.asciz	"labs"                          # string offset=2524
.Linfo_string286:
	.asciz	"llabs"                         # string offset=2529
.Linfo_string287:
	.asciz	"_Z3divB9nie220108xx"           # string offset=2535
.Linfo_string288:
	.asciz	"div"                           # string offset=2555
.Linfo_string289:
	.asciz	"ldiv"                          # string offset=2559
.Linfo_string290:
	.asciz	"lldiv"                         # string offset=2564
.Linfo_string291:
	.asciz	"mblen"                         # string offset=2570
.Linfo_string292:
	.asciz	"mbtowc"                        # string offset=2576
.Linfo_string293:
	.asciz	"wchar_t"                       # string offset=2583
.Linfo_string294:
	.asciz	"wctomb"                        # string offset=2591
.Linfo_string295:
	.asciz	"mbstowcs"                      # string offset=2598
.Linfo_string296:
	.asciz	"wcstombs"                      # string offset=2607
.Linfo_string297:
	.asciz	"at_quick_exit"                 # string offset=2616
.Linfo_string298:
	.asciz	"quick_exit"                    # string offset=2630
.Linfo_string299:
	.asciz	"aligned_alloc"                 # string offset=2641
.Linfo_string300:
	.asciz	"__count"                       # string offset=2655
.Linfo_string301:
	.asciz	"__value"                       # string offset=2663
.Linfo_string302:
	.asciz	"__wch"                         # string offset=2671
.Linfo_string303:
	.asciz	"__wchb"                        # string offset=2677
.Linfo_string304:
	.asciz	"__ARRAY_SIZE_TYPE__"           # string offset=2684
.Linfo_string305:
	.asciz	"__mbstate_t"                   # string offset=2704
.Linfo_string306:
	.asciz	"mbstate_t"                     # string offset=2716
.Linfo_string307:
	.asciz	"isalnum"                       # string offset=2726
.Linfo_string308:
	.asciz	"isalpha"                       # string offset=2734
.Linfo_string309:
	.asciz	"isblank"                       # string offset=2742
.Linfo_string310:
	.asciz	"iscntrl"                       # string offset=2750
.Linfo_string311:
	.asciz	"isdigit"                       # string offset=2758
.Linfo_string312:
	.asciz	"isgraph"                       # string offset=2766
.Linfo_string313:
	.asciz	"islower"                       # string offset=2774
.Linfo_string314:
	.asciz	"isprint"                       # string offset=2782
.Linfo_string315:
	.asciz	"ispunct"                       # string offset=2790
.Linfo_string316:
	.asciz	"isspace"                       # string offset=2798
.Linfo_string317:
	.asciz	"isupper"                       # string offset=2806
.Linfo_string318:
	.asciz	"isxdigit"                      # string offset=2814
.Linfo_string319:
	.asciz	"tolower"                       # string offset=2823
.Linfo_string320:
	.asciz	"toupper"                       # string offset=2831
.Linfo_string321:
	.asciz	"wint_t"                        # string offset=2839
.Linfo_string322:
	.asciz	"wctrans_t"                     # string offset=2846
.Linfo_string323:
	.asciz	"wctype_t"                      # string offset=2856
.Linfo_string324:
	.asciz	"iswalnum"                      # string offset=2865
.Linfo_string325:
	.asciz	"iswalpha"                      # string offset=2874
.Linfo_string326:
	.asciz	"iswblank"                      # string offset=2883
.Linfo_string327:
	.asciz	"iswcntrl"                      # string offset=2892
.Linfo_string328:
	.asciz	"iswdigit"                      # string offset=2901
.Linfo_string329:
	.asciz	"iswgraph"                      # string offset=2910
.Linfo_string330:
	.asciz	"iswlower"                      # string offset=2919
.Linfo_string331:
	.asciz	"iswprint"                      # string offset=2928
.Linfo_string332:
	.asciz	"iswpunct"                      # string offset=2937
.Linfo_string333:
	.asciz	"iswspace"                      # string offset=2946
.Linfo_string334:
	.asciz	"iswupper"                      # string offset=2955
.Linfo_string335:
	.asciz	"iswxdigit"                     # string offset=2964
.Linfo_string336:
	.asciz	"iswctype"                      # string offset=2974
.Linfo_string337:
	.asciz	"wctype"                        # string offset=2983
.Linfo_string338:
	.asciz	"towlower"                      # string offset=2990
.Linfo_string339:
	.asciz	"towupper"                      # string offset=2999
.Linfo_string340:
	.asciz	"towctrans"                     # string offset=3008
.Linfo_string341:
	.asciz	"wctrans"                       # string offset=3018
.Linfo_string342:
	.asciz	"_IO_FILE"                      # string offset=3026
.Linfo_string343:
	.asciz	"FILE"                          # string offset=3035
.Linfo_string344:
	.asciz	"fwprintf"                      # string offset=3040
.Linfo_string345:
	.asciz	"__FILE"                        # string offset=3049
.Linfo_string346:
	.asciz	"__isoc99_fwscanf"              # string offset=3056
.Linfo_string347:
	.asciz	"fwscanf"                       # string offset=3073
.Linfo_string348:
	.asciz	"swprintf"                      # string offset=3081
.Linfo_string349:
	.asciz	"vfwprintf"                     # string offset=3090
.Linfo_string350:
	.asciz	"gp_offset"                     # string offset=3100
.Linfo_string351:
	.asciz	"fp_offset"                     # string offset=3110
.Linfo_string352:
	.asciz	"overflow_arg_area"             # string offset=3120
.Linfo_string353:
	.asciz	"reg_save_area"                 # string offset=3138
.Linfo_string354:
	.asciz	"__va_list_tag"                 # string offset=3152
.Linfo_string355:
	.asciz	"vswprintf"                     # string offset=3166
.Linfo_string356:
	.asciz	"__isoc99_swscanf"              # string offset=3176
.Linfo_string357:
	.asciz	"swscanf"                       # string offset=3193
.Linfo_string358:
	.asciz	"__isoc99_vfwscanf"             # string offset=3201
.Linfo_string359:
	.asciz	"vfwscanf"                      # string offset=3219
.Linfo_string360:
	.asciz	"__isoc99_vswscanf"             # string offset=3228
.Linfo_string361:
	.asciz	"vswscanf"                      # string offset=3246
.Linfo_string362:
	.asciz	"fgetwc"                        # string offset=3255
.Linfo_string363:
	.asciz	"fgetws"                        # string offset=3262
.Linfo_string364:
	.asciz	"fputwc"                        # string offset=3269
.Linfo_string365:
	.asciz	"fputws"                        # string offset=3276
.Linfo_string366:
	.asciz	"fwide"                         # string offset=3283
.Linfo_string367:
	.asciz	"getwc"                         # string offset=3289
.Linfo_string368:
	.asciz	"putwc"                         # string offset=3295
.Linfo_string369:
	.asciz	"ungetwc"                       # string offset=3301
.Linfo_string370:
	.asciz	"wcstod"                        # string offset=3309
.Linfo_string371:
	.asciz	"wcstof"                        # string offset=3316
.Linfo_string372:
	.asciz	"wcstold"                       # string offset=3323
.Linfo_string373:
	.asciz	"wcstol"                        # string offset=3331
.Linfo_string374:
	.asciz	"wcstoll"                       # string offset=3338
.Linfo_string375:
	.asciz	"wcstoul"                       # string offset=3346
.Linfo_string376:
	.asciz	"wcstoull"                      # string offset=3354
.Linfo_string377:
	.asciz	"wcscpy"                        # string offset=3363
.Linfo_string378:
	.asciz	"wcsncpy"                       # string offset=3370
.Linfo_string379:
	.asciz	"wcscat"                        # string offset=3378
.Linfo_string380:
	.asciz	"wcsncat"                       # string offset=3385
.Linfo_string381:
	.asciz	"wcscmp"                        # string offset=3393
.Linfo_string382:
	.asciz	"wcscoll"                       # string offset=3400
.Linfo_string383:
	.asciz	"wcsncmp"                       # string offset=3408
.Linfo_string384:
	.asciz	"wcsxfrm"                       # string offset=3416
.Linfo_string385:
	.asciz	"wcschr"                        # string offset=3424
.Linfo_string386:
	.asciz	"wcspbrk"                       # string offset=3431
.Linfo_string387:
	.asciz	"wcsrchr"                       # string offset=3439
.Linfo_string388:
	.asciz	"wcsstr"                        # string offset=3447
.Linfo_string389:
	.asciz	"wmemchr"                       # string offset=3454
.Linfo_string390:
	.asciz	"wcscspn"                       # string offset=3462
.Linfo_string391:
	.asciz	"wcslen"                        # string offset=3470
.Linfo_string392:
	.asciz	"wcsspn"                        # string offset=3477
.Linfo_string393:
	.asciz	"wcstok"                        # string offset=3484
.Linfo_string394:
	.asciz	"wmemcmp"                       # string offset=3491
.Linfo_string395:
	.asciz	"wmemcpy"                       # string offset=3499
.Linfo_string396:
	.asciz	"wmemmove"                      # string offset=3507
.Linfo_string397:
	.asciz	"wmemset"                       # string offset=3516
.Linfo_string398:
	.asciz	"wcsftime"                      # string offset=3524
.Linfo_string399:
	.asciz	"btowc"                         # string offset=3533
.Linfo_string400:
	.asciz	"wctob"                         # string offset=3539
.Linfo_string401:
	.asciz	"mbsinit"                       # string offset=3545
.Linfo_string402:
	.asciz	"mbrlen"                        # string offset=3553
.Linfo_string403:
	.asciz	"mbrtowc"                       # string offset=3560
.Linfo_string404:
	.asciz	"wcrtomb"                       # string offset=3568
.Linfo_string405:
	.asciz	"mbsrtowcs"                     # string offset=3576
.Linfo_string406:
	.asciz	"wcsrtombs"                     # string offset=3586
.Linfo_string407:
	.asciz	"getwchar"                      # string offset=3596
.Linfo_string408:
	.asciz	"__isoc99_vwscanf"              # string offset=3605
.Linfo_string409:
	.asciz	"vwscanf"                       # string offset=3622
.Linfo_string410:
	.asciz	"__isoc99_wscanf"               # string offset=3630
.Linfo_string411:
	.asciz	"wscanf"                        # string offset=3646
.Linfo_string412:
	.asciz	"putwchar"                      # string offset=3653
.Linfo_string413:
	.asciz	"vwprintf"                      # string offset=3662
.Linfo_string414:
	.asciz	"wprintf"                       # string offset=3671
.Linfo_string415:
	.asciz	"_G_fpos_t"                     # string offset=3679
.Linfo_string416:
	.asciz	"__fpos_t"                      # string offset=3689
.Linfo_string417:
	.asciz	"fpos_t"                        # string offset=3698
.Linfo_string418:
	.asciz	"fclose"                        # string offset=3705
.Linfo_string419:
	.asciz	"fflush"                        # string offset=3712
.Linfo_string420:
	.asciz	"setbuf"                        # string offset=3719
.Linfo_string421:
	.asciz	"setvbuf"                       # string offset=3726
.Linfo_string422:
	.asciz	"fprintf"                       # string offset=3734
.Linfo_string423:
	.asciz	"__isoc99_fscanf"               # string offset=3742
.Linfo_string424:
	.asciz	"fscanf"                        # string offset=3758
.Linfo_string425:
	.asciz	"snprintf"                      # string offset=3765
.Linfo_string426:
	.asciz	"sprintf"                       # string offset=3774
.Linfo_string427:
	.asciz	"__isoc99_sscanf"               # string offset=3782
.Linfo_string428:
	.asciz	"sscanf"                        # string offset=3798
.Linfo_string429:
	.asciz	"vfprintf"                      # string offset=3805
.Linfo_string430:
	.asciz	"__isoc99_vfscanf"              # string offset=3814
.Linfo_string431:
	.asciz	"vfscanf"                       # string offset=3831
.Linfo_string432:
	.asciz	"__isoc99_vsscanf"              # string offset=3839
.Linfo_string433:
	.asciz	"vsscanf"                       # string offset=3856
.Linfo_string434:
	.asciz	"vsnprintf"                     # string offset=3864
.Linfo_string435:
	.asciz	"vsprintf"                      # string offset=3874
.Linfo_string436:
	.asciz	"fgetc"                         # string offset=3883
.Linfo_string437:
	.asciz	"fgets"                         # string offset=3889
.Linfo_string438:
	.asciz	"fputc"                         # string offset=3895
.Linfo_string439:
	.asciz	"fputs"                         # string offset=3901
.Linfo_string440:
	.asciz	"getc"                          # string offset=3907
.Linfo_string441:
	.asciz	"putc"                          # string offset=3912
.Linfo_string442:
	.asciz	"ungetc"                        # string offset=3917
.Linfo_string443:
	.asciz	"fread"                         # string offset=3924
.Linfo_string444:
	.asciz	"fwrite"                        # string offset=3930
.Linfo_string445:
	.asciz	"fgetpos"                       # string offset=3937
.Linfo_string446:
	.asciz	"fseek"                         # string offset=3945
.Linfo_string447:
	.asciz	"fsetpos"                       # string offset=3951
.Linfo_string448:
	.asciz	"ftell"                         # string offset=3959
.Linfo_string449:
	.asciz	"rewind"                        # string offset=3965
.Linfo_string450:
	.asciz	"clearerr"                      # string offset=3972
.Linfo_string451:
	.asciz	"feof"                          # string offset=3981
.Linfo_string452:
	.asciz	"ferror"                        # string offset=3986
.Linfo_string453:
	.asciz	"perror"                        # string offset=3993
.Linfo_string454:
	.asciz	"fopen"                         # string offset=4000
.Linfo_string455:
	.asciz	"freopen"                       # string offset=4006
.Linfo_string456:
	.asciz	"remove"                        # string offset=4014
.Linfo_string457:
	.asciz	"rename"                        # string offset=4021
.Linfo_string458:
	.asciz	"tmpfile"                       # string offset=4028
.Linfo_string459:
	.asciz	"tmpnam"                        # string offset=4036
.Linfo_string460:
	.asciz	"getchar"                       # string offset=4043
.Linfo_string461:
	.asciz	"__isoc99_scanf"                # string offset=4051
.Linfo_string462:
	.asciz	"scanf"                         # string offset=4066
.Linfo_string463:
	.asciz	"__isoc99_vscanf"               # string offset=4072
.Linfo_string464:
	.asciz	"vscanf"                        # string offset=4088
.Linfo_string465:
	.asciz	"printf"                        # string offset=4095
.Linfo_string466:
	.asciz	"putchar"                       # string offset=4102
.Linfo_string467:
	.asciz	"puts"                          # string offset=4110
.Linfo_string468:
	.asciz	"vprintf"                       # string offset=4115
.Linfo_string469:
	.asciz	"lconv"                         # string offset=4123
.Linfo_string470:
	.asciz	"setlocale"                     # string offset=4129
.Linfo_string471:
	.asciz	"localeconv"                    # string offset=4139
.Linfo_string472:
	.asciz	"__builtin_va_list"             # string offset=4150
.Linfo_string473:
	.asciz	"va_list"                       # string offset=4168
	.ident	"clang version 22.1.8"
	.section	".note.GNU-stack","",@progbits
	.addrsig
	.section	.debug_line,"",@progbits
.Lline_table_start0:
