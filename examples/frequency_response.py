"""Two steady motions of one damper at the same load: swept up the ball lies still, swept down it works."""

import rattlebox as rb

case = rb.Case(
    structure=rb.SDOF(mass="1 kg", stiffness="40 kN/m", damping_ratio=0.01),
    damper=rb.ImpactDamper(
        ball=rb.Sphere(radius="14 mm", material="steel"), gap="1 mm", contact=rb.Tsuji(restitution=0.6)
    ),
    load=rb.Harmonic(amplitude="5 N", frequency="30 Hz"),
    duration="1 s",
    method=rb.Newton(),
)
response = rb.frequency_response(case, rb.linspace("28 Hz", "31 Hz", 31))

if __name__ == "__main__":
    print(response)
    rb.plot_frequency_response(response).savefig("frequency_response.png")
