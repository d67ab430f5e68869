"""Diagrams by gnuplot, as SVG. Needs Debian's gnuplot-nox."""
import subprocess

COLOURS = {"pwlsim exact": "#1f5fbf", "pwlsim sparse": "#1b7f3b", "ngspice": "#d1480a", "gnucap": "#7a3fa0", "siconos": "#b58900"}
PALETTE = [*COLOURS.values(), "#444444", "#c2185b"]


def draw(path, size, settings, panels, columns=None):
    """Each panel is (its own settings, [(rows of x and y, style)]); more than one stand beside each other, `columns` in a row."""
    blocks, plots = [], []
    for own_settings, series in panels:
        curves = []
        for rows, style in series:
            blocks.append(f"$data{len(blocks)} << EOD\n" + "\n".join(f"{x:.6g} {y:.6g}" for x, y in rows) + "\nEOD")
            curves.append(f"$data{len(blocks) - 1} with {style}")
        plots.append(f"{own_settings}\nplot " + ", ".join(curves))
    columns = columns or len(panels)
    begin, end = ([f"set multiplot layout {-(-len(panels) // columns)},{columns}"], ["unset multiplot"]) if len(panels) > 1 else ([], [])
    script = [f"set terminal svg size {size[0]},{size[1]} font 'sans,12' background rgb 'white'", f"set output '{path}'", *blocks, "set grid lc rgb '#dddddd'", settings, *begin, *plots, *end]
    subprocess.run(["gnuplot"], input="\n".join(script), text=True, check=True, stderr=subprocess.DEVNULL)
