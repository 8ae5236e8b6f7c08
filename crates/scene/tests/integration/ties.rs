//! Markers, joints, springs and bushings: what is read, and what is refused at which place.

use dynamics::Coordinate;
use scene::{
    Body, CouplingKind, End, Joint, JointKind, Locked, Marker, MarkerAxes, MarkerPlace, Region, Scene, SceneError, Tie,
    Time,
};

const HEAD: &str = "title = 'three'\nunits = { length = 'm', mass = 'kg', time = 's' }\n";
const RIGID: &str = "rigid = { mass = 2.0, center_of_mass = [0, 0, 0], inertia = [[1, 0, 0], [0, 2, 0], [0, 0, 2]] }\n";
const MESHED: &str = "mesh = 'arm.msh'\nmaterial = { young_modulus = 2e11, poisson_ratio = 0.3, density = 7800.0 }\nmodes = { flexible = 4 }\n";
const TIME: &str = "[time]\nend = 1.0\ntolerance = 1e-5\n";

/// An arm on the ground, a hub at its tip, and a block that nothing holds.
fn three() -> String {
    format!(
        "{HEAD}[bodies.arm]\n{MESHED}\
         [bodies.arm.markers.tip]\ngroup = 'tip face'\nz = [0, 0, 5]\nx = [1, 0, 1]\n\
         [bodies.arm.markers.root]\nat = [0, 0, 0]\nradius = 0.1\n\
         [bodies.arm.markers.middle]\nat = [0.5, 0, 0]\n\
         [bodies.hub]\n{RIGID}markers = {{ left = {{ at = [-0.2, 0, 0] }} }}\n\
         [bodies.block]\n{RIGID}\
         [ground.markers.wall]\nat = [0, 1, 0]\nz = [1, 0, 0]\n\
         [[joints]]\nname = 'shoulder'\nkind = 'revolute'\nbetween = ['arm.root', 'ground']\naxis = [0, 3, 4]\n\
         [joints.drive]\namplitude = 2.0\nhistory = {{ kind = 'ramp', duration = 0.5 }}\n\
         [[joints]]\nkind = 'cylindrical'\nbetween = ['arm.tip', 'hub.left']\n\
         [joints.spring]\nalong = 'slide'\nstiffness = 10.0\nfree = 0.1\npreload = -1.0\n\
         stops = {{ high = 0.2, stiffness = 1e4, damping = 1.0 }}\nfriction = {{ force = 0.5, rate = 1e-3 }}\n\
         [[springs]]\nbetween = ['arm.middle', 'ground.wall']\nstiffness = 100.0\n\
         [[bushings]]\nname = 'rubber'\nbetween = ['ground', 'hub.left']\nstiffness = {{ translation = [1, 2, 3] }}\n{TIME}"
    )
}

fn parse(text: &str) -> Result<Scene, SceneError> {
    Scene::parse(text, "three.toml")
}

#[test]
fn a_constraint_of_a_body_in_joints_is_a_joint_to_the_ground() {
    let with = |constraints: &str| {
        let modes = "modes = { flexible = 4 }";
        let text = three().replacen(modes, &format!("{modes}\nconstraints = [{constraints}]"), 1);
        let scene = parse(&text).unwrap();
        assert!(scene.bodies[0].reduced_constraint().is_none());
        let of_ground = |joint: &&Joint| joint.key.starts_with("bodies.arm.constraints");
        scene.joints.iter().filter(of_ground).cloned().collect::<Vec<_>>()
    };
    let [hinge] = &with("{ kind = 'hinge', at = [0, 0, 0], axis = [0, 1, 0], group = 'root' }")[..] else { panic!() };
    assert_eq!((&*hinge.key, &*hinge.name), ("bodies.arm.constraints[0]", "arm_constraint1"));
    assert_eq!(hinge.kind, JointKind::Revolute);
    assert_eq!(hinge.between, [End::Ground { marker: None }, End::Body { body: 0, marker: 3 }]);
    let part = |axis| format!("{{ kind = 'support', directions = ['{axis}'], group = 'root' }}");
    let names: Vec<_> = with(&format!("{}, {}", part("x"), part("z"))).into_iter().map(|joint| joint.name).collect();
    assert_eq!(names, ["arm_constraint1", "arm_constraint2"]);
    // Without joints of its own the body keeps it.
    let block =
        three().replacen("[bodies.block]", "[bodies.block]\nconstraints = [{ kind = 'pin', at = [0, 0, 0] }]", 1);
    assert!(parse(&block).unwrap().bodies[2].reduced_constraint().is_some());
}

#[test]
fn all_keys_are_read() {
    let scene = parse(&three()).unwrap();
    let [arm, hub, block] = &scene.bodies[..] else { panic!() };
    assert_eq!([arm, hub, block].map(|body| (body.tied, body.markers.len())), [(true, 3), (true, 1), (false, 0)]);
    let [tip, root, middle] = &arm.markers[..] else { panic!() };
    assert_eq!(tip.place, MarkerPlace::Region(Region::Group("tip face".into())));
    let Some(MarkerAxes { z, x: Some(x) }) = tip.axes else { panic!() };
    assert_eq!((z, x), ([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), "x is made to be at right angles to z");
    assert_eq!(root.place, MarkerPlace::Region(Region::Ball { at: [0.0; 3], radius: 0.1 }));
    let expected =
        Marker { name: "middle".into(), place: MarkerPlace::Point([0.5, 0.0, 0.0]), tie: Tie::Mean, axes: None };
    assert_eq!(*middle, expected);

    let [shoulder, wrist] = &scene.joints[..] else { panic!() };
    assert_eq!(
        (&*shoulder.name, shoulder.kind, shoulder.axis),
        ("shoulder", JointKind::Revolute, Some([0.0, 0.6, 0.8]))
    );
    assert_eq!(shoulder.between, [End::Body { body: 0, marker: 1 }, End::Ground { marker: None }]);
    let drive = shoulder.drive.as_ref().unwrap();
    assert_eq!((drive.along, drive.amplitude), (Coordinate::Turn, 2.0));
    assert_eq!((&*wrist.name, wrist.kind, wrist.axis), ("joint2", JointKind::Cylindrical, None));
    assert_eq!(wrist.between, [End::Body { body: 0, marker: 0 }, End::Body { body: 1, marker: 0 }]);
    let spring = wrist.spring.unwrap();
    assert_eq!((spring.along, spring.stiffness, spring.damping), (Coordinate::Slide, 10.0, 0.0));
    assert_eq!((spring.free, spring.preload), (0.1, -1.0));
    let stops = spring.stops.unwrap();
    assert_eq!((stops.limits, stops.stiffness, stops.damping), ([f64::NEG_INFINITY, 0.2], 1e4, 1.0));
    let friction = spring.friction.unwrap();
    assert_eq!((friction.force, friction.rate_scale), (0.5, 1e-3));

    let spring = &scene.springs[0];
    assert_eq!((&*spring.name, spring.stiffness, spring.free_length), ("spring1", 100.0, None));
    assert_eq!(spring.between, [End::Body { body: 0, marker: 2 }, End::Ground { marker: Some(0) }]);
    let bushing = &scene.bushings[0];
    assert_eq!((&*bushing.name, bushing.stiffness.translation), ("rubber", [1.0, 2.0, 3.0]));
    assert_eq!((bushing.stiffness.rotation, bushing.damping.translation), ([0.0; 3], [0.0; 3]));
    assert_eq!((scene.ground[0].at, scene.ground[0].axes.unwrap().z), ([0.0, 1.0, 0.0], [1.0, 0.0, 0.0]));
    let place = scene.place("joints[1].spring.free");
    assert_eq!((place.line, &*place.key), (38, "joints[1].spring.free"));
}

#[test]
fn joints_without_a_kind_and_couplings_are_read_and_refused() {
    let text = three().replace("kind = 'revolute'", "locked = ['x', 'y', 'z', 'rx', 'ry']").replace(
        "[time]",
        "[[couplings]]\nkind = 'rack'\njoints = ['shoulder', 'joint2']\nradius = 0.5\n\
         [[couplings]]\nname = 'thread'\nkind = 'screw'\njoint = 'joint2'\nlead = 1e-3\n[time]",
    );
    let scene = parse(&text).unwrap();
    let locked = Locked { displacements: [true; 3], turns: [true, true, false] };
    assert_eq!((scene.joints[0].kind, JointKind::Revolute.locked()), (JointKind::Other(locked), locked));
    let nothing = parse(&format!(
        "{HEAD}[bodies.hub]\n{RIGID}markers = {{ left = {{ at = [0, 0, 0] }} }}\n\
         [[joints]]\nlocked = []\nbetween = ['ground', 'hub.left']\naxis = [0, 0, 1]\n{TIME}"
    ))
    .unwrap();
    let none = Locked { displacements: [false; 3], turns: [false; 3] };
    assert_eq!((nothing.joints[0].kind, nothing.joints[0].kind.coordinates()), (JointKind::Other(none), &[][..]));
    assert_eq!(scene.couplings[0].kind, CouplingKind::Rack { joints: [0, 1], radius: 0.5 });
    let [rack, screw] = [0, 1].map(|i| &*scene.couplings[i].name);
    assert_eq!(
        (rack, screw, scene.couplings[1].kind),
        ("coupling1", "thread", CouplingKind::Screw { joint: 1, lead: 1e-3 })
    );
    for (from, to, key, words) in [
        ("'rx', 'ry'", "'rx', 'rx'", "joints[0].locked[4]", "each once"),
        ("'rx', 'ry'", "'rx', 'ru'", "joints[0].locked[4]", "some of"),
        ("locked = [", "kind = 'fixed'\nlocked = [", "joints[0].locked", "both `kind` and `locked`"),
        ("locked = ['x', 'y', 'z', 'rx', 'ry']\n", "", "joints[0].kind", "`kind` is missing"),
        ("'shoulder', 'joint2'", "'sholder', 'joint2'", "couplings[0].joints[0]", "did you mean `shoulder`?"),
        ("'shoulder', 'joint2'", "'joint2', 'shoulder'", "couplings[0].joints[1]", "which has no slide"),
        ("'shoulder', 'joint2'", "'joint2', 'joint2'", "couplings[0].joints", "two different joints"),
        ("'shoulder', 'joint2'", "'joint2'", "couplings[0].joints", "1 names"),
        ("joint = 'joint2'", "joint = 'shoulder'", "couplings[1].joint", "which has no slide"),
        ("lead = 1e-3", "lead = 0", "couplings[1].lead", "not 0"),
        ("'thread'", "'rubber'", "couplings[1].name", "each name once"),
        ("'rack'", "'rak'", "couplings[0].kind", "did you mean `rack`?"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = parse(&text.replacen(from, to, 1)).expect_err(to);
        assert_eq!(&*error.place().unwrap().key, key, "{error}");
        assert!(error.to_string().contains(words), "{words}: {error}");
    }
}

/// The scene of a body in joints is a scene without them.
#[test]
fn the_text_of_a_body_alone_has_its_markers_and_no_joints() {
    let system = parse(&three().replace("[time]", "[time]\nscheme = 'radau'")).unwrap();
    for body in &system.bodies {
        let alone = Body::parse(&body.text_alone, "three.toml").unwrap();
        assert!(!alone.tied);
        let time = Time { method: *body.time.method.without_joints(), ..body.time };
        assert_eq!((&alone.markers, alone.time), (&body.markers, time));
        let named = Body::parse_body(&body.text, "three.toml", body.name.as_deref()).unwrap();
        assert_eq!(named, *body);
    }
}

#[test]
fn one_body_can_be_tied_to_the_ground() {
    let text = format!(
        "{HEAD}[body]\n{RIGID}markers = {{ top = {{ at = [0, 0, 1] }} }}\n\
         [[joints]]\nkind = 'spherical'\nbetween = ['body.top', 'ground']\n{TIME}scheme = 'radau'\n"
    );
    let scene = parse(&text).unwrap();
    assert!(scene.bodies[0].tied && scene.bodies[0].name.is_none());
    assert_eq!(scene.joints[0].between[0], End::Body { body: 0, marker: 0 });
    assert_eq!(Body::parse(&text, "three.toml").unwrap(), scene.bodies[0]);
    let free = text.replace("[[joints]]\nkind = 'spherical'\nbetween = ['body.top', 'ground']\n", "");
    let error = parse(&free).unwrap_err();
    assert_eq!(error.place().unwrap().key, "time.scheme", "{error}");
}

#[test]
fn refusals_name_the_place_and_the_way_out() {
    let refused = [
        // Ends.
        ("'arm.root', 'ground'", "'arm.rot', 'ground'", "joints[0].between[0]", "did you mean `root`?"),
        ("'arm.root', 'ground'", "'army.root', 'ground'", "joints[0].between[0]", "did you mean `arm`?"),
        (
            "'arm.root', 'ground'",
            "'arm', 'ground'",
            "joints[0].between[0]",
            "\"arm.tip\", \"arm.root\", \"arm.middle\"",
        ),
        ("'arm.root', 'ground'", "'block.root', 'ground'", "joints[0].between[0]", "has none"),
        ("'arm.root', 'ground'", "'arm.root', 'ground.wal'", "joints[0].between[1]", "did you mean `wall`?"),
        ("'arm.root', 'ground'", "'arm.root', 'arm.root'", "joints[0].between", "\"arm.root\" twice"),
        ("'arm.root', 'ground'", "'arm.root', 'arm.tip'", "joints[0].between", "two markers of one body"),
        ("'arm.root', 'ground'", "'ground.wall', 'ground'", "joints[0].between", "the ground at both ends"),
        ("'arm.root', 'ground'", "'arm.root'", "joints[0].between", "1 names"),
        ("'ground.wall']\nstiffness", "'ground']\nstiffness", "springs[0].between[1]", "a place on the ground"),
        ("'arm.root', 'ground'", "'ground.wall', 'arm.middle'", "springs[0].between", "a line between them"),
        (
            "[[springs]]",
            "[[joints]]\nname = 'one'\nkind = 'spherical'\nbetween = ['hub.left', 'arm.middle']\n\
             [[joints]]\nname = 'two'\nkind = 'fixed'\nbetween = ['hub.left', 'ground.wall']\n[[springs]]",
            "springs[0].between",
            "that joints \"two\", \"one\" hold together",
        ),
        // Axes.
        ("axis = [0, 3, 4]", "axis = [0, 0, 0]", "joints[0].axis", "a vector that is not zero"),
        ("axis = [0, 3, 4]\n", "", "joints[0]", "a revolute joint without an axis"),
        ("z = [0, 0, 5]\n", "", "bodies.arm.markers.tip.z", "`z` is missing"),
        ("x = [1, 0, 1]", "x = [0, 0, -2]", "bodies.arm.markers.tip.x", "other than that of `z`"),
        ("z = [0, 0, 5]", "z = [0, 0, 0]", "bodies.arm.markers.tip.z", "a vector that is not zero"),
        ("'arm.root', 'ground']", "'arm.tip', 'ground.wall']", "joints[0].axis", "whose markers both have axes"),
        // Markers.
        ("group = 'tip face'", "group = 'tip face'\npatches = 1", "bodies.arm.markers.tip.patches", "from 2 to 32"),
        ("group = 'tip face'", "group = 'tip face'\npatches = 33", "bodies.arm.markers.tip.patches", "from 2 to 32"),
        ("group = 'tip face'", "group = 'tip face'\ntie = 'node'", "bodies.arm.markers.tip.tie", "`nodes`"),
        (
            "group = 'tip face'",
            "group = 'tip face'\npatches = 2\ntie = 'nodes'",
            "bodies.arm.markers.tip.tie",
            "beside `patches`",
        ),
        (
            "group = 'tip face'",
            "group = 'tip face'\npatches = 2\ntie = 'rigid'",
            "bodies.arm.markers.tip.tie",
            "`tie = \"rigid\"` beside `patches`",
        ),
        (
            "group = 'tip face'",
            "group = 'tip face'\nalong = [0, 1, 0]",
            "bodies.arm.markers.tip.along",
            "without `patches`",
        ),
        (
            "group = 'tip face'",
            "group = 'tip face'\npatches = 2\nalong = [0, 0, 0]",
            "bodies.arm.markers.tip.along",
            "a vector that is not zero",
        ),
        ("group = 'tip face'", "at = [0, 0, 0]\npatches = 2", "bodies.arm.markers.tip.patches", "a marker at a point"),
        ("group = 'tip face'", "at = [0, 0, 0]\ntie = 'nodes'", "bodies.arm.markers.tip.tie", "a marker at a point"),
        (
            "group = 'tip face'",
            "group = 'tip face'\nat = [0, 0, 0]",
            "bodies.arm.markers.tip.group",
            "both `at` and `group`",
        ),
        ("group = 'tip face'\n", "", "bodies.arm.markers.tip", "none of `at`, `box` and `group`"),
        ("at = [-0.2, 0, 0]", "group = 'a'", "bodies.hub.markers.left.group", "has no mesh"),
        ("markers.middle", "markers.'mid.dle'", "bodies.arm.markers.\"mid.dle\"", "without `.`"),
        ("at = [0, 1, 0]\n", "", "ground.markers.wall.at", "`at` is missing"),
        // Names.
        ("name = 'shoulder'", "name = 'a.b'", "joints[0].name", "without `.`"),
        ("name = 'shoulder'", "name = 'joint2'", "joints[1].name", "each name once"),
        ("name = 'rubber'", "name = 'shoulder'", "bushings[0].name", "each name once"),
        ("[bodies.block]", "[bodies.ground]", "bodies.ground", "the name of the ground"),
        // Kinds and coordinates.
        ("'revolute'", "'hinge'", "joints[0].kind", "did you mean `revolute`?"),
        ("'revolute'", "'spherical'", "joints[0].drive", "no turn about an axis"),
        ("along = 'slide'\n", "", "joints[1].spring", "which turns and slides"),
        ("[joints.drive]\n", "[joints.drive]\nalong = 'slide'\n", "joints[0].drive.along", "its turn"),
        ("[joints.drive]", "[joints.motor]\namplitude = 1.0\n[joints.drive]", "joints[0].motor", "that `drive` gives"),
        ("[joints.drive]", "[joints.driv]", "joints[0].driv", "did you mean `drive`?"),
        // Numbers.
        ("stiffness = 10.0", "stiffness = -10.0", "joints[1].spring.stiffness", "0 or more"),
        ("high = 0.2, stiffness", "low = 0.3, high = 0.2, stiffness", "joints[1].spring.stops.high", "above `low`"),
        ("high = 0.2, stiffness", "stiffness", "joints[1].spring.stops", "`low`, `high` or both"),
        ("rate = 1e-3", "rate = 0", "joints[1].spring.friction.rate", "greater than 0"),
        ("translation = [1, 2, 3]", "translation = [1, 2, -3]", "bushings[0].stiffness.translation[2]", "0 or more"),
        ("translation = [1, 2, 3]", "translation = [0, 0, 0]", "bushings[0]", "that is not zero"),
        ("duration = 0.5", "duration = -0.5", "joints[0].drive.history.duration", "greater than 0"),
        // Bodies.
        (
            "modes = { flexible = 4 }",
            "modes = { flexible = 4 }\nconstraints = [{ kind = 'slider', direction = [1, 0, 0], group = 'g', motion = { amplitude = 1, history = { kind = 'constant' } } }]",
            "bodies.arm.constraints[0].motion",
            "whose `drive` gives",
        ),
        (
            "modes = { flexible = 4 }",
            "modes = { flexible = 4 }\nconstraints = [{ kind = 'pin', at = [0, 0, 0] }]\n\
             loads = [{ kind = 'base-acceleration', direction = [1, 0, 0], amplitude = 1, history = { kind = 'constant' } }]",
            "bodies.arm.loads[0].kind",
            "`kind = \"gravity\"` in the opposite direction",
        ),
        (
            "modes = { flexible = 4 }\n",
            "modes = { flexible = 4 }\nconstraints = [{ kind = 'pin', at = [0, 0, 0] }]\n[[couplings]]\nname = 'arm_constraint1'\n\
             kind = 'screw'\njoint = 'joint2'\nlead = 1\n",
            "couplings[0].name",
            "each name once",
        ),
        (
            "modes = { flexible = 4 }",
            "modes = { flexible = 4 }\neffects = { rotation = false }",
            "bodies.arm.effects.rotation",
            "`rotation = false` of a body",
        ),
        // Schemes.
        ("[time]", "[time]\nformulation = 'paper'", "time.formulation", "the paper's scheme has no joints"),
        ("[time]", "[time]\nscheme = 'exponential'", "time.scheme", "`radau`"),
    ];
    for (from, to, key, words) in refused {
        let text = three();
        assert!(text.contains(from), "{from}");
        let error = parse(&text.replacen(from, to, 1)).expect_err(to);
        let place = error.place().unwrap();
        assert_eq!(&*place.key, key, "{error}");
        assert!(error.to_string().contains(words), "{words}: {error}");
    }
}
