"""Script for ``quartus_sh -t``: compiles the project, and says how large and how fast it became."""

from build.quartus.assignments import NAME

__all__ = ["compile_tcl"]


def compile_tcl():
    """The script as text."""
    return f"""# Compile the project and print what matters of its reports: quartus_sh -t compile.tcl
load_package flow
load_package report

project_open -force {NAME} -revision {NAME}
if {{[catch {{execute_flow -compile}} message]}} {{
    project_close
    puts stderr "The compilation failed: $message"
    exit 1
}}

proc show {{pattern}} {{
    foreach panel [get_report_panel_names] {{
        if {{![string match $pattern $panel]}} continue
        puts "\\n$panel"
        set id [get_report_panel_id $panel]
        for {{set row 0}} {{$row < [get_number_of_rows -id $id]}} {{incr row}} {{
            puts "  [join [get_report_panel_row -id $id -row $row] {{ | }}]"
        }}
    }}
}}

load_report
show "Fitter||Fitter Summary"
show "*Fmax Summary"
show "*Setup Summary"
show "*Hold Summary"
unload_report
project_close
"""
