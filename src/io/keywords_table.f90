!> The one table of all keywords and keys: the parser, `--keywords` and the manual are made from it.
module xmpm_keywords_table
   use xmpm_keywords, only: keyword_t, key_t, add_keyword, add_key, kind_integer, kind_word, &
      kind_text, kind_flag, kind_axis, may_have_name, must_have_name
   implicit none
   private

   public :: make_keyword_table

   character(len=*), parameter :: positive = '(0, inf)'
   character(len=*), parameter :: not_negative = '[0, inf)'
   integer, parameter :: any_number = huge(1)   !! as many values as one likes

contains

   !> Every keyword with its keys, in the order of the manual.
   pure subroutine make_keyword_table(t)
      type(keyword_t), allocatable, intent(out) :: t(:)   !! the table

      call add_general(t)
      call add_materials_and_bodies(t)
      call add_cracks(t)
      call add_loads(t)
      call add_solution(t)
      call add_results(t)
      call add_keyword(t, keyword_t(name='end', required=.true., directive=.true., &
         meaning='closes the deck; a deck without it is taken for a truncated one'))
   end subroutine make_keyword_table

   pure subroutine add_general(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='job', naming=must_have_name, required=.true., &
         meaning='name of the run; it heads the names of all output files'))

      call add_keyword(t, keyword_t(name='units', always=.true., &
         meaning='consistent units of all numbers; nothing is ever converted'))
      call add_key(t, key_t(name='length', kind=kind_word, default='m', &
         words='m mm cm um km in ft', &
         meaning='unit of length'))
      call add_key(t, key_t(name='mass', kind=kind_word, default='kg', words='kg g t mg', &
         meaning='unit of mass'))
      call add_key(t, key_t(name='time', kind=kind_word, default='s', words='s ms us ns', &
         meaning='unit of time'))

      call add_keyword(t, keyword_t(name='parameter', repeatable=.true., directive=.true., &
         meaning='name = expression, ...: names for numbers, usable in any expression of the deck'))
      call add_keyword(t, keyword_t(name='include', repeatable=.true., directive=.true., &
         meaning='another file whose lines stand here; its path is relative to this file'))

      call add_keyword(t, keyword_t(name='grid', required=.true., &
         meaning='background grid of cubic cells, without bounds; it costs only where material is'))
      call add_key(t, key_t(name='size', dimension='length', range=positive, required=.true., &
         meaning='edge of a cell'))
      call add_key(t, key_t(name='shape', kind=kind_word, default='linear', words='linear gimp', &
         meaning='shape functions: linear hats or uniform GIMP'))
      call add_key(t, key_t(name='origin', least=3, most=3, dimension='length', default='0 0 0', &
         meaning='a node of the grid: x y z'))
   end subroutine add_general

   pure subroutine add_materials_and_bodies(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='material', naming=must_have_name, required=.true., &
         repeatable=.true., meaning='a material that bodies are made of'))
      call add_key(t, key_t(name='law', kind=kind_word, default='elastic', words='elastic', &
         meaning='constitutive law: linear elastic with the Jaumann rate'))
      call add_key(t, key_t(name='density', dimension='density', range=positive, required=.true., &
         meaning='mass density'))
      call add_key(t, key_t(name='young', dimension='stress', range=positive, required=.true., &
         meaning='Young''s modulus'))
      call add_key(t, key_t(name='poisson', range='(-1, 0.5)', required=.true., &
         meaning='Poisson''s ratio'))
      call add_key(t, key_t(name='toughness', dimension='toughness', range=positive, &
         meaning='fracture toughness K_Ic, for cracks that grow'))

      call add_keyword(t, keyword_t(name='body', naming=must_have_name, required=.true., &
         repeatable=.true., &
         meaning='particles from a file, or from primitives added and cut out in written order'))
      call add_key(t, key_t(name='material', kind=kind_text, required=.true., &
         meaning='name of a *MATERIAL'))
      call add_key(t, key_t(name='particles', kind=kind_integer, range='[1, 4]', default='2', &
         meaning='particles per cell and direction'))
      call add_primitives(t)
      call add_key(t, key_t(name='file', kind=kind_text, &
         meaning='particle file (HDF5) instead of primitives'))
      call add_key(t, key_t(name='part', kind=kind_text, &
         meaning='name of the body in the particle file; all its particles where not given'))
      call add_key(t, key_t(name='velocity', least=3, most=3, dimension='velocity', &
         default='0 0 0', &
         meaning='initial velocity: x y z'))
      call add_key(t, key_t(name='spin', least=3, most=3, dimension='rate', default='0 0 0', &
         meaning='initial angular velocity: x y z'))
      call add_key(t, key_t(name='spin_centre', least=3, most=3, dimension='length', &
         default='0 0 0', &
         meaning='point that the spin turns about: x y z'))
      call add_key(t, key_t(name='stress', least=6, most=6, dimension='stress', &
         default='0 0 0 0 0 0', &
         meaning='uniform initial stress: xx yy zz xy yz xz'))
      call add_key(t, key_t(name='rigid', kind=kind_flag, &
         meaning='does not strain or turn; it moves by the forces on it and needs a *CONTACT'))
      call add_key(t, key_t(name='mass', dimension='mass', range=positive, &
         meaning='of a rigid body; from its volume and density where not given'))
      call add_key(t, key_t(name='held', kind=kind_text, most=3, &
         meaning='letters out of x y z in which a rigid body keeps its velocity, whatever acts'))
      call add_relations(t)
   end subroutine add_materials_and_bodies

   !> What is said of bodies once they are there.
   pure subroutine add_relations(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='set', naming=must_have_name, repeatable=.true., &
         meaning='a named set of particles: those of a body in a box at the start'))
      call add_key(t, key_t(name='body', kind=kind_text, required=.true., &
         meaning='name of a *BODY'))
      call add_key(t, key_t(name='box', least=6, most=6, dimension='length', required=.true., &
         meaning='corners: x0 y0 z0 x1 y1 z1'))

      call add_keyword(t, keyword_t(name='contact', repeatable=.true., &
         meaning='bodies that meet; those that none names together stick as one'))
      call add_key(t, key_t(name='bodies', kind=kind_text, most=any_number, required=.true., &
         meaning='names of *BODY blocks, each against all others; or all'))
      call add_key(t, key_t(name='friction', range=not_negative, default='0', &
         meaning='coefficient of Coulomb friction'))
      call add_key(t, key_t(name='normal', least=3, most=3, &
         meaning='of the faces that meet, from the body that stands first in the deck; found '// &
         'where not given'))
   end subroutine add_relations

   !> The shapes of bodies, each with its twin that cuts the shape out.
   pure subroutine add_primitives(t)
      type(keyword_t), intent(inout) :: t(:)
      character(len=8), parameter :: shape(4) = [character(len=8) :: 'box', 'cylinder', 'tube', &
         'sphere']
      integer, parameter :: count(4) = [6, 7, 8, 4]
      character(len=48), parameter :: values(4) = [character(len=48) :: &
         'corners x0 y0 z0 x1 y1 z1', 'ends of the axis x0 y0 z0 x1 y1 z1 and radius', &
         'ends of the axis x0 y0 z0 x1 y1 z1, r_in, r_out', 'centre x y z and radius']
      integer :: i

      do i = 1, size(shape)
         call add_key(t, key_t(name=shape(i), least=count(i), most=count(i), dimension='length', &
            repeatable=.true., meaning='adds a '//trim(shape(i))//': '//values(i)))
      end do
      do i = 1, size(shape)
         call add_key(t, key_t(name='without_'//shape(i), least=count(i), most=count(i), &
            dimension='length', repeatable=.true., meaning='cuts out a '//trim(shape(i))//': ' &
            //values(i)))
      end do
   end subroutine add_primitives

   pure subroutine add_cracks(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='crack', naming=must_have_name, repeatable=.true., &
         meaning='a crack surface: one shape, or a file of triangles'))
      call add_key(t, key_t(name='rectangle', kind=kind_flag, &
         meaning='shape with centre, along, across, width, depth'))
      call add_key(t, key_t(name='disc', kind=kind_flag, &
         meaning='shape with centre, along, across, radius'))
      call add_key(t, key_t(name='ellipse', kind=kind_flag, &
         meaning='shape with centre, along, across, semi_axes'))
      call add_key(t, key_t(name='polygon', kind=kind_flag, meaning='plane shape with points'))
      call add_key(t, key_t(name='file', kind=kind_text, &
         meaning='triangle file instead of a shape: .stl or .h5'))
      call add_key(t, key_t(name='centre', least=3, most=3, dimension='length', &
         meaning='centre of the shape: x y z'))
      call add_key(t, key_t(name='along', least=3, most=3, &
         meaning='direction of the width or of the first semi-axis: x y z'))
      call add_key(t, key_t(name='across', least=3, most=3, &
         meaning='direction of the depth or of the second semi-axis; the normal is along x across'))
      call add_key(t, key_t(name='width', dimension='length', range=positive, &
         meaning='of the rectangle, along'))
      call add_key(t, key_t(name='depth', dimension='length', range=positive, &
         meaning='of the rectangle, across'))
      call add_key(t, key_t(name='radius', dimension='length', range=positive, &
         meaning='of the disc'))
      call add_key(t, key_t(name='semi_axes', least=2, most=2, dimension='length', range=positive, &
         meaning='of the ellipse, along and across'))
      call add_key(t, key_t(name='points', least=9, most=any_number, dimension='length', &
         meaning='corners of the polygon, in order: x y z x y z ...'))
      call add_key(t, key_t(name='sector', least=2, most=2, dimension='angle', &
         range='[-360, 360]', &
         meaning='part of a disc or an ellipse: from and to, in degrees from along towards across'))
      call add_key(t, key_t(name='element', dimension='length', range=positive, &
         meaning='edge of the triangles; the cell size where not given'))
      call add_key(t, key_t(name='front', kind=kind_word, default='graded', &
         words='graded node full cut', &
         meaning='rule by which nodes near the front are enriched'))
      call add_key(t, key_t(name='ramp', range='(0, 4]', default='0.5', &
         meaning='graded front: length over which the weight falls from 1 to 0, in cells'))
      call add_key(t, key_t(name='ramp_end', range='[-4, 4]', default='0.4', &
         meaning='graded front: distance ahead of the front at which the weight is 0, in cells'))
      call add_key(t, key_t(name='contact', kind=kind_word, default='none', &
         words='none frictionless friction', &
         meaning='contact of the faces with each other, where they are closed; '// &
         'without it a warning tells of overlaps'))
      call add_key(t, key_t(name='friction', range=not_negative, &
         meaning='coefficient of Coulomb friction of the faces; for contact = friction'))
   end subroutine add_cracks

   pure subroutine add_loads(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='curve', naming=must_have_name, repeatable=.true., &
         meaning='a factor over time, linear between its points and constant outside'))
      call add_key(t, key_t(name='table', least=2, most=any_number, required=.true., &
         meaning='points: time factor time factor ...'))

      call add_keyword(t, keyword_t(name='load', naming=may_have_name, repeatable=.true., &
         meaning='a traction or a pressure on a face of a body or on a set'))
      call add_key(t, key_t(name='face', kind=kind_text, &
         meaning='BODY:FACE, with +x -x +y -y +z -z, side (lateral surface) or inside (of a tube)'))
      call add_key(t, key_t(name='set', kind=kind_text, &
         meaning='name of a *SET, loaded as a surface layer'))
      call add_key(t, key_t(name='traction', least=3, most=3, dimension='stress', &
         meaning='force on an area: x y z'))
      call add_key(t, key_t(name='pressure', dimension='stress', &
         meaning='against the outer normal of the face'))
      call add_time_keys(t)

      call add_keyword(t, keyword_t(name='gravity', repeatable=.true., &
         meaning='a body force on all particles'))
      call add_key(t, key_t(name='acceleration', least=3, most=3, dimension='acceleration', &
         required=.true., &
         meaning='force on a mass: x y z'))
      call add_time_keys(t)

      call add_keyword(t, keyword_t(name='boundary', naming=may_have_name, repeatable=.true., &
         meaning='a condition on the grid nodes of a plane, of a box or around a set'))
      call add_key(t, key_t(name='plane', kind=kind_axis, dimension='length', &
         meaning='nodes on and beyond a plane: x, y or z and its coordinate'))
      call add_key(t, key_t(name='box', least=6, most=6, dimension='length', &
         meaning='nodes in a box: x0 y0 z0 x1 y1 z1'))
      call add_key(t, key_t(name='set', kind=kind_text, &
         meaning='nodes around the particles of a *SET'))
      call add_key(t, key_t(name='type', kind=kind_word, required=.true., &
         words='fixed roller symmetry velocity acceleration', meaning='what is prescribed'))
      call add_key(t, key_t(name='components', kind=kind_text, most=3, &
         meaning='letters out of x y z that are prescribed; all where not given'))
      call add_key(t, key_t(name='value', least=1, most=3, &
         meaning='velocity or acceleration: x y z, or one number for each of the components'))
      call add_time_keys(t)
   end subroutine add_loads

   !> The keys of all that acts over time.
   pure subroutine add_time_keys(t)
      type(keyword_t), intent(inout) :: t(:)

      call add_key(t, key_t(name='curve', kind=kind_text, default='step', &
         meaning='factor over time: step, ramp or the name of a *CURVE'))
      call add_key(t, key_t(name='rise', dimension='time', range=positive, &
         meaning='time in which the ramp grows from 0 to 1'))
      call add_key(t, key_t(name='start', dimension='time', default='0', &
         meaning='time at which the step, the ramp or the *CURVE begins'))
   end subroutine add_time_keys

   pure subroutine add_solution(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='time', required=.true., &
         meaning='length of the run and how it is stepped'))
      call add_key(t, key_t(name='end', dimension='time', range=positive, required=.true., &
         meaning='end of the run'))
      call add_key(t, key_t(name='scheme', kind=kind_word, default='musl', words='musl usf usl', &
         meaning='order of the stages in a step'))
      call add_key(t, key_t(name='cfl', range=positive, default='0.5', &
         meaning='time step as a part of cell size over wave speed'))
      call add_key(t, key_t(name='transfer', kind=kind_word, default='flip', words='flip xpic', &
         meaning='velocity update of the particles: FLIP or XPIC(2)'))
      call add_key(t, key_t(name='inertia', kind=kind_word, default='lumped', &
         words='lumped corrected', meaning='mass of the nodes: lumped, or corrected for what '// &
         'transfers smooth, so that short waves keep their speed'))
      call add_key(t, key_t(name='step', dimension='time', range=positive, &
         meaning='fixed time step instead of the automatic one'))
      call add_key(t, key_t(name='steps', kind=kind_integer, range='[0, inf)', &
         meaning='most steps to take; the run ends at whichever comes first'))

      call add_keyword(t, keyword_t(name='damping', always=.true., &
         meaning='damping of the motion; none by default'))
      call add_key(t, key_t(name='viscous', dimension='rate', range=not_negative, default='0', &
         meaning='nodal viscous damping: part of the momentum lost in a unit of time'))
      call add_key(t, key_t(name='pic', dimension='rate', range=not_negative, default='0', &
         meaning='part of PIC in the transfer, for a unit of time'))
      call add_key(t, key_t(name='until', dimension='time', range=not_negative, &
         meaning='end of the damping; the whole run where not given'))

      call add_keyword(t, keyword_t(name='relax', &
         meaning='bodies come to rest under the loads before t = 0; then dynamics are released'))
      call add_key(t, key_t(name='method', kind=kind_word, default='kinetic', &
         words='kinetic viscous', &
         meaning='kinetic: stop all motion at each peak of kinetic energy'))
      call add_key(t, key_t(name='rate', dimension='rate', range=positive, &
         meaning='of viscous relaxation'))
      call add_key(t, key_t(name='residual', range='(0, 1)', default='1e-3', &
         meaning='force out of balance at rest, over the largest so far with the reactions'))
      call add_key(t, key_t(name='limit', dimension='time', range=positive, required=.true., &
         meaning='longest time to relax; not to reach the residual by then is a failure'))

      call add_keyword(t, keyword_t(name='health', always=.true., &
         meaning='limits at which a run is given up'))
      call add_key(t, key_t(name='energy', range='[0, inf)', default='0.1', &
         meaning='largest error of the energy balance, as a part of the energy; 0 for no limit'))
      call add_key(t, key_t(name='smallest_step', range='[0, 1)', default='1e-3', &
         meaning='smallest time step, as a part of the first'))

      call add_keyword(t, keyword_t(name='partition', always=.true., &
         meaning='division of the work among ranks'))
      call add_key(t, key_t(name='imbalance', range='(1, inf)', default='1.2', &
         meaning='most particles of a rank over the mean, at which the work is divided anew'))
   end subroutine add_solution

   pure subroutine add_results(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='output', always=.true., &
         meaning='what is written, and how often'))
      call add_key(t, key_t(name='every', dimension='time', range=positive, &
         meaning='interval of the ParaView files; start and end of the run where not given'))
      call add_key(t, key_t(name='particles', kind=kind_word, most=any_number, &
         default='displacement velocity stress', &
         words='displacement velocity stress energy material body psi phi side id rank none', &
         meaning='fields of the particles'))
      call add_key(t, key_t(name='crack', kind=kind_word, most=any_number, default='opening', &
         words='opening displacement normal none', meaning='fields of the crack surfaces'))
      call add_key(t, key_t(name='history', dimension='time', range=positive, &
         meaning='interval of the rows of energy and probe tables; that of every where not given'))

      call add_keyword(t, keyword_t(name='fracture', &
         meaning='J and stress intensity factors at the crack fronts, into NAME_front.csv'))
      call add_key(t, key_t(name='every', dimension='time', range=positive, &
         meaning='interval of the values'))
      call add_key(t, key_t(name='at', most=any_number, dimension='time', range=not_negative, &
         meaning='single times of the values'))
      call add_key(t, key_t(name='cracks', kind=kind_text, most=any_number, &
         meaning='names of the *CRACK blocks; all that have a front where not given'))
      call add_key(t, key_t(name='methods', kind=kind_word, most=any_number, default='domain', &
         words='domain contour paper', &
         meaning='estimators of J: the first answers, the others widen the error bars'))
      call add_key(t, key_t(name='radii', most=any_number, dimension='length', range=positive, &
         meaning='radii of the domains, growing; 3, 4 and 5 cells where not given'))
      call add_key(t, key_t(name='window', dimension='length', range=positive, &
         meaning='half-width of the window along the front; 2 cells where not given'))
      call add_key(t, key_t(name='behind', dimension='length', range=positive, &
         meaning='distance behind the front of the openings that part the modes; 2 cells where '// &
         'not given'))

      call add_growth(t)

      call add_keyword(t, keyword_t(name='probe', naming=must_have_name, repeatable=.true., &
         meaning='a quantity written over time: at a point, through a section or from a boundary'))
      call add_key(t, key_t(name='point', least=3, most=3, dimension='length', &
         meaning='place whose nearest particle is followed: x y z'))
      call add_key(t, key_t(name='quantity', kind=kind_word, words='displacement velocity stress', &
         meaning='what is written at the point; displacement where not given'))
      call add_key(t, key_t(name='section', kind=kind_axis, dimension='length', &
         meaning='plane whose resultant force is written: x, y or z and its coordinate'))
      call add_key(t, key_t(name='reaction', kind=kind_text, &
         meaning='name of a *BOUNDARY whose force is written'))
   end subroutine add_results

   !> Growth of cracks.
   pure subroutine add_growth(t)
      type(keyword_t), allocatable, intent(inout) :: t(:)

      call add_keyword(t, keyword_t(name='growth', repeatable=.true., &
         meaning='growth of cracks: where to, how fast, from when'))
      call add_key(t, key_t(name='cracks', kind=kind_text, most=any_number, &
         meaning='names of the *CRACK blocks; all where not given'))
      call add_key(t, key_t(name='criterion', kind=kind_word, default='hoop', &
         words='hoop schoellmann straight', &
         meaning='direction and K*: largest hoop stress, largest principal stress, or the plane'))
      call add_key(t, key_t(name='law', kind=kind_word, default='running', &
         words='running constant table speed position', &
         meaning='speed: K_Ic/(1 - C/C_R), constant K_Ic, table of K_ID, or prescribed'))
      call add_key(t, key_t(name='table', least=4, most=any_number, &
         meaning='law = table: speed and K_ID, pair after pair; law = position: time and way'))
      call add_key(t, key_t(name='speed', dimension='velocity', range=not_negative, &
         meaning='law = speed: of every point of the fronts'))
      call add_key(t, key_t(name='start', dimension='time', range=not_negative, default='0', &
         meaning='no growth before this time'))
      call add_key(t, key_t(name='increment', range='[0.1, 2]', default='0.5', &
         meaning='way after which the surface gets new triangles, in cells'))
      call add_key(t, key_t(name='filter', dimension='time', range=not_negative, &
         meaning='time over which K is averaged; 3.5 cells at the fastest wave where not given'))
      call add_key(t, key_t(name='every', dimension='time', range=positive, &
         meaning='interval of K for the law; 0.5 cells at the fastest wave where not given'))
      call add_key(t, key_t(name='meeting', dimension='length', range=positive, &
         meaning='fronts of a crack that face each other nearer than this are joined; '// &
         'twice the largest radius where not given'))
      call add_key(t, key_t(name='toughness', dimension='toughness', range=positive, &
         meaning='K_Ic for these cracks in all bodies, instead of those of the materials'))
      call add_key(t, key_t(name='region', least=7, most=7, repeatable=.true., &
         meaning='a box of its own toughness: x0 y0 z0 x1 y1 z1 K_Ic; the last one counts'))
   end subroutine add_growth
end module xmpm_keywords_table
